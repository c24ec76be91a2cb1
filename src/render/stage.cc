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

} // namespace

void SurfaceLanes::resize(std::size_t count) {
    for (VectorLanes* lanes : {&position, &origin, &tangent, &bitangent, &normal})
        lanes->resize(count);
}

void SurfaceLanes::set(std::size_t lane, const StagePoint& point) {
    position.set(lane, point.position);
    origin.set(lane, point.origin);
    tangent.set(lane, point.shading.tangent);
    bitangent.set(lane, point.shading.bitangent);
    normal.set(lane, point.shading.normal);
}

Frames SurfaceLanes::frames() {
    return {{tangent.x.data(), tangent.y.data(), tangent.z.data()},
            {bitangent.x.data(), bitangent.y.data(), bitangent.z.data()},
            {normal.x.data(), normal.y.data(), normal.z.data()}};
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
    : scene_(scene), rays_(scene.surface->positions, scene.surface->triangles),
      floorMaterial_(OpticsModel::energyConserving, V3f(scene.groundAlbedo)), upright_(uprightFrame(scene.up)) {
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

StagePoint Stage::floorPoint(const V3f& origin, const V3f& direction) const {
    const Floor floor = floorAlong(origin, direction);
    StagePoint point;
    point.position = origin + direction * floor.distance;
    if (!floor.isTable)
        point.position += upright_.normal * (floorHeight_ - (point.position ^ upright_.normal));
    point.origin = point.position + floor.normal * clearance_;
    point.shading = floor.normal != upright_.normal ? frameAround(floor.normal) : upright_;
    return point;
}

void Stage::shade(const RayBatch& rays, const HitBatch& hits, const std::vector<int>& from, std::size_t count,
                  SurfaceLanes& at, VectorLanes& wo) const {
    const SurfaceMesh& mesh = *scene_.surface;
    const auto read = [](const VectorLanes& v) { return ConstVectors{v.x.data(), v.y.data(), v.z.data()}; };
    const auto write = [](VectorLanes& v) { return Vectors{v.x.data(), v.y.data(), v.z.data()}; };
    shadeLanes({BsdfBatch::padded(count), from.data(), hits.triangle.data(), hits.u.data(), hits.v.data(),
                read(hits.geometricNormal), read(rays.direction), &mesh.triangles[0].x, &mesh.positions[0].x,
                &mesh.normals[0].x, clearance_, write(at.position), write(at.origin), at.frames(), write(wo)});
}

void Stage::materials(const HitBatch& hits, const std::vector<int>& from, std::size_t count, BsdfBatch& into) const {
    if (scene_.materials) {
        scene_.materials(hits, from, count, into);
        return;
    }
    for (std::size_t i = 0; i < count; ++i) {
        const auto hit = std::size_t(from[i]);
        const SurfacePoint point{hits.triangle[hit], hits.u[hit], hits.v[hit]};
        into.set(i, scene_.material(point, V3f(positionAt(*scene_.surface, point))));
    }
}

bool Stage::setBlocks(const V3f& from, const V3f& direction, float distance) const {
    if (scene_.ground) {
        const float height = from ^ upright_.normal, rising = direction ^ upright_.normal;
        if (std::isinf(distance) ? rising < -1e-7f && height > floorHeight_ : height + rising * distance < floorHeight_)
            return true;
    }
    return table_ && table_->intersect(from, direction, distance);
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

std::optional<V3f> Stage::seenByCamera() const {
    return scene_.ground ? backdrop_ : scene_.background;
}

} // namespace patina
