#include "render/stage.h"

#include "base/turns.h"

#include <algorithm>
#include <limits>

namespace patina {

using Imath::V3f;
using Imath::V3i;

namespace {

constexpr float pi = float(M_PI);
// The floor fades into the backdrop between these distances from the object's middle, in radii.
constexpr float fadeFrom = 1.3f;
constexpr float fadeTo = 25.f;
// The backdrop is darker than the lit floor: the object stands in a pool of light.
constexpr float backdropShade = 0.42f;

// Of the turntable: its radius in those of the circle around the object's footprint, its thickness in radii of the
// object.
constexpr float tableSize = 1.08f;
constexpr float tableThickness = 0.05f;

// Turns a shading normal just so far that a mirror ray along it does not go into the triangle (Keller et al. 2017, "The
// Iray Light Transport Simulation and Rendering System", bends it likewise). Without it, silhouettes of coarse meshes
// go black where the smooth normal looks away from the viewer.
V3f bendTowards(const V3f& normal, const V3f& geometric, const V3f& wo) {
    const V3f mirrored = 2.f * (wo ^ normal) * normal - wo;
    const float least = std::min(0.9f * (wo ^ geometric), 0.02f);
    const float below = least - (mirrored ^ geometric);
    if (below <= 0.f && (wo ^ normal) > 0.f)
        return normal;
    const V3f lifted = unit(mirrored + std::max(below, 0.f) * geometric);
    const V3f bent = wo + lifted;
    return bent.length2() > 1e-8f ? unit(bent) : geometric;
}

} // namespace

BsdfValue SeenLambert::evaluate(const V3f& wi) const {
    return wi.z > 0.f ? BsdfValue{V3f(albedo / pi), wi.z / pi} : BsdfValue{};
}

BsdfSample SeenLambert::sample(const V3f& u) const {
    // Uniform on the disc below, lifted to the hemisphere (Malley): density cos / pi, weight the albedo.
    const float r = std::sqrt(u.x);
    const CirclePoint around = circlePoint(u.y);
    const float z = std::sqrt(std::max(0.f, 1.f - u.x));
    return {{r * around.cosine, r * around.sine, z}, z / pi, V3f(albedo)};
}

Stage::Stage(const RenderScene& scene, const Lights& lights) : Stage(scene) {
    const V3f middle = centre_ + upright_.normal * (floorHeight_ - (centre_ ^ upright_.normal));
    backdrop_ = lights.irradiance(upright_.normal, middle) * (scene.groundAlbedo / pi * backdropShade);
}

bool Stage::isInside(const V3f& position) const {
    if (!scene_.surface->closed)
        return false;
    int backs = 0;
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {-1.f, 1.f}) {
            V3f direction(0.03f, 0.05f, 0.07f); // off the axes, along which meshes have their edges
            direction[axis] = sign;
            const auto hit = rays_.intersect(position, direction);
            backs += hit && (hit->geometricNormal ^ direction) > 0.f;
        }
    return backs > 3;
}

Stage::Stage(const RenderScene& scene)
    : scene_(scene), rays_(scene.surface->positions, scene.surface->triangles), upright_(uprightFrame(scene.up)) {
    const Imath::Box3f box = scene.setting ? *scene.setting : scene.surface->bounds();
    centre_ = box.center();
    radius_ = std::max(0.5f * box.size().length(), 1e-20f);
    float lowest = std::numeric_limits<float>::infinity();
    float farthest = 0.f;
    for (const V3f& p : scene.surface->positions) {
        lowest = std::min(lowest, p ^ upright_.normal);
        farthest = std::max({farthest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
    if (scene.setting)
        lowest = std::min(box.min ^ upright_.normal, box.max ^ upright_.normal); // up is an axis
    // A hair below, so that a sheet that lies on the floor is seen and not the floor.
    floorHeight_ = lowest - 1e-3f * radius_;
    if (scene.ground && scene.turntable) {
        V3f across = box.size();
        across -= upright_.normal * (across ^ upright_.normal);
        table_.emplace(centre_ + upright_.normal * (floorHeight_ - (centre_ ^ upright_.normal)), upright_.normal,
                       tableSize * 0.5f * across.length(), tableThickness * radius_);
        floorHeight_ -= table_->thickness();
    }
    // A hit is placed by barycentric weights, to a few units in the last place of the coordinates.
    clearance_ = 4e-6f * std::max(farthest, radius_);
}

Stage::Floor Stage::floorAlong(const V3f& origin, const V3f& direction) const {
    Floor floor{std::numeric_limits<float>::infinity(), upright_.normal, false};
    if (!scene_.ground)
        return floor;
    const float height = (origin ^ upright_.normal) - floorHeight_;
    const float sinking = -(direction ^ upright_.normal);
    if (height > 0.f && sinking > 1e-7f)
        floor.distance = height / sinking;
    if (table_)
        if (const auto hit = table_->intersect(origin, direction, floor.distance))
            floor = {hit->distance, hit->normal, true};
    return floor;
}

float Stage::reach(const V3f& origin, const V3f& direction) const {
    return floorAlong(origin, direction).distance;
}

StageHit Stage::intersect(const V3f& origin, const V3f& direction, bool indirect, StagePoint& point) const {
    return meet(rays_.intersect(origin, direction, 0.f, reach(origin, direction)), origin, direction, indirect, point);
}

StageHit Stage::meet(const std::optional<RayScene::Hit>& hit, const V3f& origin, const V3f& direction, bool indirect,
                     StagePoint& point) const {
    if (hit) {
        const bool back = (hit->geometricNormal ^ direction) > 0.f;
        if (back && indirect && scene_.surface->closed)
            return StageHit::inside;
        shadeSurface(*hit, direction, back, point);
        return StageHit::surface;
    }
    const Floor floor = floorAlong(origin, direction);
    if (!std::isfinite(floor.distance))
        return StageHit::nothing;
    point.position = origin + direction * floor.distance;
    if (!floor.isTable)
        point.position += upright_.normal * (floorHeight_ - (point.position ^ upright_.normal));
    point.origin = point.position + floor.normal * clearance_;
    point.shading = floor.normal != upright_.normal ? frameAround(floor.normal) : upright_;
    return StageHit::ground;
}

void Stage::shadeSurface(const RayScene::Hit& hit, const V3f& direction, bool back, StagePoint& point) const {
    const SurfaceMesh& mesh = *scene_.surface;
    const V3i& triangle = mesh.triangles[std::size_t(hit.point.triangle)];
    const float weights[3] = {1.f - hit.point.u - hit.point.v, hit.point.u, hit.point.v};
    const float side = back ? -1.f : 1.f;
    V3f position(0.f), normal(0.f);
    for (int i = 0; i < 3; ++i) {
        position += mesh.positions[std::size_t(triangle[i])] * weights[i];
        normal += mesh.normals[std::size_t(triangle[i])] * (weights[i] * side);
    }
    const V3f geometric = hit.geometricNormal.normalized() * side;
    normal = normal.length2() > 1e-12f ? unit(normal) : geometric;
    if ((normal ^ geometric) <= 0.f)
        normal = geometric;

    // The triangle stands for a curved surface that bulges out over it. Starting shadow rays from the planes through
    // the corners, weighted, instead of from the flat triangle takes the black facets off the terminator (Hanika 2021,
    // "Hacking the Shadow Terminator", Ray Tracing Gems II, chapter 4).
    V3f lift(0.f);
    for (int i = 0; i < 3; ++i) {
        const V3f cornerNormal = mesh.normals[std::size_t(triangle[i])] * side;
        const float below = std::min(0.f, (position - mesh.positions[std::size_t(triangle[i])]) ^ cornerNormal);
        lift -= cornerNormal * (below * weights[i]);
    }
    point.surface = hit.point;
    point.position = position;
    point.origin = position + lift + geometric * clearance_;
    point.shading = frameAround(bendTowards(normal, geometric, -direction));
}

bool Stage::setBlocks(const StagePoint& from, const V3f& direction, float distance) const {
    if (scene_.ground) {
        const float height = from.origin ^ upright_.normal, rising = direction ^ upright_.normal;
        if (std::isinf(distance) ? rising < -1e-7f && height > floorHeight_ : height + rising * distance < floorHeight_)
            return true;
    }
    return table_ && table_->intersect(from.origin, direction, distance);
}

float Stage::backdropShare(const V3f& floorPoint) const {
    V3f aside = floorPoint - centre_;
    aside -= upright_.normal * (aside ^ upright_.normal);
    // Even in one over the distance, which is how a picture shows a floor: a gradient without an edge up to the
    // horizon.
    const float nearness = radius_ / std::max(aside.length(), 1e-3f * radius_);
    const float t = std::clamp((1.f / fadeFrom - nearness) / (1.f / fadeFrom - 1.f / fadeTo), 0.f, 1.f);
    return t * t * (3.f - 2.f * t);
}

V3f Stage::seenByCamera(const Lights& lights, const V3f& direction) const {
    if (scene_.ground)
        return backdrop_;
    return scene_.background ? *scene_.background : lights.radiance(direction);
}

} // namespace patina
