#include "surface/ray_scene.h"

#include "base/errors.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace patina {

using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

namespace {

/// Embree's context with the best hit so far of each ray, by its ID, for ties between triangles that share the edge a
/// ray passes through.
struct NearestContext {
    RTCIntersectContext context;
    float distance[RayScene::packetSize];
    unsigned triangle[RayScene::packetSize];
};

/// Two triangles hit at exactly the same distance: the order of traversal depends on how the tree was built, so the
/// smaller index wins.
void keepSmallestIndex(const RTCFilterFunctionNArguments* arguments) {
    if (arguments->context == nullptr)
        return;
    auto* nearest = reinterpret_cast<NearestContext*>(arguments->context);
    for (unsigned i = 0; i < arguments->N; ++i) {
        if (arguments->valid[i] != -1)
            continue;
        const unsigned ray = RTCRayN_id(arguments->ray, arguments->N, i);
        const float distance = RTCRayN_tfar(arguments->ray, arguments->N, i);
        const unsigned triangle = RTCHitN_primID(arguments->hit, arguments->N, i);
        if (distance == nearest->distance[ray] && triangle > nearest->triangle[ray]) {
            arguments->valid[i] = 0;
            continue;
        }
        nearest->distance[ray] = distance;
        nearest->triangle[ray] = triangle;
    }
}

/// Rays beyond the packet's count are switched off, but get numbers that Embree may calculate with.
void fillQuery(const RayBatch& rays, std::size_t first, int count, RTCRay16& query, int* valid) {
    const auto put = [&](const std::vector<float>& from, float* to) {
        const float* numbers = from.data() + first;
        std::copy_n(numbers, count, to);
        std::fill(to + count, to + RayScene::packetSize, numbers[0]);
    };
    put(rays.origin.x, query.org_x);
    put(rays.origin.y, query.org_y);
    put(rays.origin.z, query.org_z);
    put(rays.direction.x, query.dir_x);
    put(rays.direction.y, query.dir_y);
    put(rays.direction.z, query.dir_z);
    put(rays.farthest, query.tfar);
    for (int i = 0; i < RayScene::packetSize; ++i) {
        valid[i] = i < count ? -1 : 0;
        query.tnear[i] = 0.f;
        query.time[i] = 0.f;
        query.mask[i] = 0xffffffffu;
        query.id[i] = static_cast<unsigned>(i);
        query.flags[i] = 0;
    }
}

struct TrianglePoint {
    double u, v;
    double squaredDistance;
};

/// The closest point of the segment p + s d, s in 0…1, as s.
double closestOnSegment(const V3d& fromStart, const V3d& direction) {
    const double squaredLength = direction.dot(direction);
    if (squaredLength <= 0.0)
        return 0.0;
    return std::min(1.0, std::max(0.0, fromStart.dot(direction) / squaredLength));
}

/// Closest point of a triangle, degenerate ones included: inside if the foot of the perpendicular is inside, else on
/// the nearest of the three edges.
TrianglePoint closestOnTriangle(const V3d& p, const V3d& a, const V3d& b, const V3d& c) {
    const V3d ab = b - a, ac = c - a, ap = p - a;
    const double d00 = ab.dot(ab), d01 = ab.dot(ac), d11 = ac.dot(ac);
    const double determinant = d00 * d11 - d01 * d01;
    if (determinant > 1e-14 * d00 * d11) {
        const double d20 = ap.dot(ab), d21 = ap.dot(ac);
        const double u = (d11 * d20 - d01 * d21) / determinant;
        const double v = (d00 * d21 - d01 * d20) / determinant;
        if (u >= 0.0 && v >= 0.0 && u + v <= 1.0) {
            const V3d offset = ap - u * ab - v * ac;
            return {u, v, offset.dot(offset)};
        }
    }
    const double s = closestOnSegment(ap, ab), t = closestOnSegment(ap, ac), r = closestOnSegment(p - b, c - b);
    const V3d onAb = ap - s * ab, onAc = ap - t * ac, onBc = p - b - r * (c - b);
    TrianglePoint best{s, 0.0, onAb.dot(onAb)};
    if (onAc.dot(onAc) < best.squaredDistance)
        best = {0.0, t, onAc.dot(onAc)};
    if (onBc.dot(onBc) < best.squaredDistance)
        best = {1.0 - r, r, onBc.dot(onBc)};
    return best;
}

constexpr float leastFacing = 0.3f, mostAlike = 0.8f; // cosines

/// A triangle's corners side by side: a query touches hundreds of scattered triangles, and memory is what it waits for.
struct Corners {
    V3f a, b, c;
};

struct ClosestSearch {
    const Corners* corners;
    V3d position;
    V3f facing; ///< 0: any
    V3f unlike; ///< 0: none
    float radius;
    int triangle = -1;
    float distance = 0.f;
    TrianglePoint point{};
};

bool visitTriangle(RTCPointQueryFunctionArguments* arguments) {
    auto& search = *static_cast<ClosestSearch*>(arguments->userPtr);
    const int index = static_cast<int>(arguments->primID);
    const Corners& corners = search.corners[index];
    if (search.facing != V3f(0.f)) {
        const V3f normal = (corners.b - corners.a).cross(corners.c - corners.a);
        const float length = normal.length();
        if (!((normal ^ search.facing) > leastFacing * length) || (normal ^ search.unlike) > mostAlike * length)
            return false;
    }
    const TrianglePoint point = closestOnTriangle(search.position, V3d(corners.a), V3d(corners.b), V3d(corners.c));
    // Distances are compared as floats, so that neighbours which share the closest corner or edge tie exactly.
    const auto distance = static_cast<float>(std::sqrt(point.squaredDistance));
    if (!(distance <= search.radius))
        return false;
    if (search.triangle >= 0 &&
        !(distance < search.distance || (distance == search.distance && index < search.triangle)))
        return false;
    search.triangle = index;
    search.distance = distance;
    search.point = point;
    // A little wider than the best, or nodes that hold a tie would be skipped. Embree measures in single precision, so
    // the slack also covers the size of the coordinates.
    const float scale =
        static_cast<float>(std::abs(search.position.x) + std::abs(search.position.y) + std::abs(search.position.z));
    const float radius = distance * (1.f + 1e-5f) + 1e-6f * scale;
    if (radius < arguments->query->radius) {
        arguments->query->radius = radius;
        return true;
    }
    return false;
}

} // namespace

struct RayScene::Scene {
    std::vector<Corners> corners;
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    ~Scene() {
        if (scene)
            rtcReleaseScene(scene);
        if (device)
            rtcReleaseDevice(device);
    }
};

RayScene::RayScene(const std::vector<V3f>& positions, const std::vector<V3i>& triangles)
    : scene_(std::make_unique<Scene>()) {
    scene_->corners.reserve(triangles.size());
    for (const V3i& triangle : triangles)
        scene_->corners.push_back({positions[triangle.x], positions[triangle.y], positions[triangle.z]});
    const auto check = [this](const void* made) {
        if (made)
            return;
        throw RunError("ray scene",
                       rtcGetDeviceError(scene_->device) == RTC_ERROR_OUT_OF_MEMORY
                           ? "not enough memory for the rays' search tree"
                           : "Embree refused the model",
                       "a coarser model or fewer subdivisions need less memory");
    };
    scene_->device = rtcNewDevice(nullptr);
    check(scene_->device);
    scene_->scene = rtcNewScene(scene_->device);
    check(scene_->scene);
    rtcSetSceneFlags(scene_->scene, RTC_SCENE_FLAG_ROBUST);

    if (!triangles.empty()) {
        RTCGeometry geometry = rtcNewGeometry(scene_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
        check(geometry);
        void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(V3f),
                                                 positions.size());
        void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(V3i),
                                                triangles.size());
        if (vertices)
            std::memcpy(vertices, positions.data(), positions.size() * sizeof(V3f));
        if (indices)
            std::memcpy(indices, triangles.data(), triangles.size() * sizeof(V3i));
        rtcSetGeometryIntersectFilterFunction(geometry, keepSmallestIndex);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_->scene, geometry);
        rtcReleaseGeometry(geometry);
        check(vertices);
        check(indices);
    }
    rtcCommitScene(scene_->scene);
    if (const RTCError error = rtcGetDeviceError(scene_->device); error != RTC_ERROR_NONE)
        throw RunError("ray scene", error == RTC_ERROR_OUT_OF_MEMORY ? "not enough memory for the rays' search tree"
                                                                     : "Embree refused the model");
}

RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

std::optional<RayScene::Hit> RayScene::intersect(const V3f& origin, const V3f& direction, float nearest,
                                                 float farthest) const {
    NearestContext context;
    rtcInitIntersectContext(&context.context);
    context.distance[0] = -1.f;
    RTCRayHit query{};
    query.ray.org_x = origin.x;
    query.ray.org_y = origin.y;
    query.ray.org_z = origin.z;
    query.ray.dir_x = direction.x;
    query.ray.dir_y = direction.y;
    query.ray.dir_z = direction.z;
    query.ray.tnear = nearest;
    query.ray.tfar = farthest;
    query.ray.mask = 0xffffffffu;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_->scene, &context.context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID)
        return std::nullopt;
    const RTCHit& hit = query.hit;
    return Hit{{static_cast<int>(hit.primID), hit.u, hit.v}, query.ray.tfar, {hit.Ng_x, hit.Ng_y, hit.Ng_z}};
}

std::optional<RayScene::FaceHit> RayScene::firstFace(const V3f& origin, const V3f& direction, float farthest) const {
    const auto hit = intersect(origin, direction, 0.f, farthest);
    if (!hit)
        return std::nullopt;
    const Corners& c = scene_->corners[hit->point.triangle];
    const V3d ab(c.b - c.a), ac(c.c - c.a), bc(c.c - c.b);
    const double longest = std::max({ab.length(), ac.length(), bc.length()});
    const double width = longest > 0.0 ? ab.cross(ac).length() / longest : 0.0;
    return FaceHit{hit->distance, hit->geometricNormal.normalized(), static_cast<float>(width)};
}

void RayScene::intersect(const RayBatch& rays, bool coherent, HitBatch& hits) const {
    hits.resize(std::max(hits.triangle.size(), rays.count));
    alignas(64) int valid[packetSize];
    alignas(64) RTCRayHit16 query;
    for (std::size_t first = 0; first < rays.count; first += packetSize) {
        const int count = static_cast<int>(std::min<std::size_t>(packetSize, rays.count - first));
        NearestContext context;
        rtcInitIntersectContext(&context.context);
        if (coherent)
            context.context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        fillQuery(rays, first, count, query.ray, valid);
        for (int i = 0; i < packetSize; ++i) {
            context.distance[i] = -1.f;
            query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
            query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(valid, scene_->scene, &context.context, &query);
        for (int i = 0; i < count; ++i)
            hits.triangle[first + i] =
                query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID ? -1 : static_cast<int>(query.hit.primID[i]);
        std::copy_n(query.hit.u, count, hits.u.data() + first);
        std::copy_n(query.hit.v, count, hits.v.data() + first);
        std::copy_n(query.ray.tfar, count, hits.distance.data() + first);
        std::copy_n(query.hit.Ng_x, count, hits.geometricNormal.x.data() + first);
        std::copy_n(query.hit.Ng_y, count, hits.geometricNormal.y.data() + first);
        std::copy_n(query.hit.Ng_z, count, hits.geometricNormal.z.data() + first);
    }
}

void RayScene::occluded(const RayBatch& rays, std::vector<char>& blocked) const {
    // Embree takes a stream of rays in its own order, octant by octant.
    constexpr std::size_t streamSize = 256;
    RTCRay stream[streamSize];
    blocked.resize(std::max(blocked.size(), rays.count));
    for (std::size_t first = 0; first < rays.count; first += streamSize) {
        const std::size_t count = std::min(streamSize, rays.count - first);
        for (std::size_t i = 0; i < count; ++i) {
            const V3f origin = rays.origin[first + i], direction = rays.direction[first + i];
            stream[i] = {origin.x,
                         origin.y,
                         origin.z,
                         0.f,
                         direction.x,
                         direction.y,
                         direction.z,
                         0.f,
                         rays.farthest[first + i],
                         0xffffffffu,
                         static_cast<unsigned>(i),
                         0};
        }
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcOccluded1M(scene_->scene, &context, stream, static_cast<unsigned>(count), sizeof(RTCRay));
        for (std::size_t i = 0; i < count; ++i)
            blocked[first + i] = stream[i].tfar < 0.f;
    }
}

bool RayScene::occluded(const V3f& origin, const V3f& direction, float nearest, float farthest) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay ray{};
    ray.org_x = origin.x;
    ray.org_y = origin.y;
    ray.org_z = origin.z;
    ray.dir_x = direction.x;
    ray.dir_y = direction.y;
    ray.dir_z = direction.z;
    ray.tnear = nearest;
    ray.tfar = farthest;
    ray.mask = 0xffffffffu;
    rtcOccluded1(scene_->scene, &context, &ray);
    return ray.tfar < 0.f;
}

std::optional<RayScene::Closest> RayScene::closest(const V3f& position, float radius) const {
    return search(position, radius, V3f(0.f), V3f(0.f));
}

std::optional<RayScene::Closest> RayScene::closestFacing(const V3f& position, const V3f& direction, float radius,
                                                         const V3f& unlike) const {
    return search(position, radius, direction.normalized(), unlike);
}

std::optional<RayScene::Closest> RayScene::search(const V3f& position, float radius, const V3f& facing,
                                                  const V3f& unlike) const {
    if (scene_->corners.empty())
        return std::nullopt;
    ClosestSearch search;
    search.corners = scene_->corners.data();
    search.position = V3d(position);
    search.facing = facing;
    search.unlike = unlike;
    search.radius = radius;
    RTCPointQuery query;
    query.x = position.x;
    query.y = position.y;
    query.z = position.z;
    query.time = 0.f;
    query.radius = radius;
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_->scene, &query, &context, visitTriangle, &search);
    if (search.triangle < 0)
        return std::nullopt;
    return Closest{{search.triangle, static_cast<float>(search.point.u), static_cast<float>(search.point.v)},
                   search.distance};
}

} // namespace patina
