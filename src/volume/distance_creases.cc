#include "volume/distance_creases.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

namespace patina {

namespace {

// The plane or planes that meet near a seed on a sharp crease, and where they do.
struct Crease {
    Imath::V3f point;
    Imath::V3f along;     ///< unit; zero where three planes meet
    float reach;          ///< how far it goes on both ways
    Imath::V3f normal[3]; ///< of the faces
    int faces;
    bool convex;
};

// The point nearest to the origin that minimises the squared distances to some of the planes normal · (p - place) = 0
// (Garland and Heckbert's quadric): (sum n n^T + e) q = sum n (n · place), where e keeps q near the origin along an
// edge.
template <typename Chosen>
Imath::V3f meetingPoint(const Imath::V3f* normals, const Imath::V3f* places, int count, Chosen chosen) {
    double A[3][3] = {{1e-3, 0.0, 0.0}, {0.0, 1e-3, 0.0}, {0.0, 0.0, 1e-3}}, r[3] = {};
    for (int i = 0; i < count; ++i) {
        if (!chosen(i))
            continue;
        const double d = double(normals[i].dot(places[i]));
        for (int x = 0; x < 3; ++x) {
            r[x] += double(normals[i][x]) * d;
            for (int y = 0; y < 3; ++y)
                A[x][y] += double(normals[i][x]) * double(normals[i][y]);
        }
    }
    const double c00 = A[1][1] * A[2][2] - A[1][2] * A[2][1], c01 = A[0][2] * A[2][1] - A[0][1] * A[2][2],
                 c02 = A[0][1] * A[1][2] - A[0][2] * A[1][1];
    const double c11 = A[0][0] * A[2][2] - A[0][2] * A[2][0], c12 = A[0][2] * A[1][0] - A[0][0] * A[1][2],
                 c22 = A[0][0] * A[1][1] - A[0][1] * A[1][0];
    const double determinant = A[0][0] * c00 + A[1][0] * c01 + A[2][0] * c02; // > 0: A is positive definite
    return {float((c00 * r[0] + c01 * r[1] + c02 * r[2]) / determinant),
            float((c01 * r[0] + c11 * r[1] + c12 * r[2]) / determinant),
            float((c02 * r[0] + c12 * r[1] + c22 * r[2]) / determinant)};
}

// Values of a level set say where faces are, but no cell knows the edge between two: its seed lies on a chord. Where a
// seed is so curved that it can only be on an edge, the planes of the flat seeds around it are intersected.
bool findCrease(const SurfaceSeeds& seeds, std::uint32_t s, Crease& crease) {
    constexpr float reach = 2.2f, flat = 0.15f;
    const PointBlocks& points = seeds.points;
    const openvdb::Coord& home = points.blocks[points.blockOf[s]].block;
    const Imath::V3f here(points.x[s], points.y[s], points.z[s]);
    std::array<Imath::V3f, 64> normals, places;
    std::array<float, 64> bent;
    int count = 0;
    const auto side = [](float v, int& from, int& to) {
        from = v < reach ? -1 : 0;
        to = v > 8.f - reach ? 1 : 0;
    };
    int from[3], to[3];
    for (int axis = 0; axis < 3; ++axis)
        side(here[axis], from[axis], to[axis]);
    for (int i = from[0]; i <= to[0]; ++i)
        for (int j = from[1]; j <= to[1]; ++j)
            for (int k = from[2]; k <= to[2]; ++k) {
                const std::int32_t number = points.lattice.at(home.offsetBy(i, j, k));
                if (number < 0)
                    continue;
                const Imath::V3f origin(8.f * float(i), 8.f * float(j), 8.f * float(k));
                for (std::uint32_t o = points.blocks[number].begin; o < points.blocks[number].end; ++o) {
                    const Imath::V3f place = origin + Imath::V3f(points.x[o], points.y[o], points.z[o]);
                    const Imath::V3f apart = place - here;
                    if (apart.dot(apart) > reach * reach || seeds.patches[o].bentness() > flat || count == 64)
                        continue;
                    normals[count] = seeds.patches[o].normal;
                    bent[count] = seeds.patches[o].bentness();
                    places[count++] = apart;
                }
            }
    if (count < 4)
        return false;
    // The faces that meet: that of the nearest flat seed, the nearest of another direction, the nearest of a third that
    // leaves the plane of those two and makes a corner.
    const auto nearestWhere = [&](auto condition) {
        int found = -1;
        for (int i = 0; i < count; ++i)
            if (condition(i) && (found < 0 || places[i].dot(places[i]) < places[found].dot(places[found])))
                found = i;
        return found;
    };
    const int a = nearestWhere([](int) { return true; });
    const int b = nearestWhere([&](int i) { return normals[i].dot(normals[a]) < 0.9f; });
    if (b < 0 || normals[a].dot(normals[b]) < -0.8f)
        return false;
    crease.along = normals[a].cross(normals[b]).normalized();
    const int c = nearestWhere([&](int i) { return std::abs(normals[i].dot(crease.along)) > 0.3f; });
    crease.reach = SurfacePatch::furthestReach;
    const auto belongs = [&](int i, int face) { return face >= 0 && normals[i].dot(normals[face]) > 0.97f; };
    const Imath::V3f edge =
        meetingPoint(normals.data(), places.data(), count, [&](int i) { return belongs(i, a) || belongs(i, b); });
    crease.point = edge;
    if (c >= 0) {
        // Where along the edge the third face cuts it: a corner there, or an edge that ends there.
        const float end = normals[c].dot(places[c] - edge) / normals[c].dot(crease.along);
        if (std::abs(end) < 0.5f) {
            crease.point = meetingPoint(normals.data(), places.data(), count,
                                        [&](int i) { return belongs(i, a) || belongs(i, b) || belongs(i, c); });
            crease.along = Imath::V3f(0.f);
        } else {
            crease.reach = std::min(crease.reach, std::abs(end));
        }
    }
    // A face's normal is that of its flattest seed, of equals that of the nearest.
    crease.faces = 0;
    for (const int face : {a, b, crease.along == Imath::V3f(0.f) ? c : -1}) {
        if (face < 0)
            continue;
        int best = face;
        for (int i = 0; i < count; ++i)
            if (belongs(i, face)) {
                const float gain = bent[best] - bent[i];
                if (gain > 0.01f || (gain > -0.01f && places[i].dot(places[i]) < places[best].dot(places[best])))
                    best = i;
            }
        crease.normal[crease.faces++] = normals[best];
    }
    const Imath::V3f q = crease.point;
    crease.convex = q.dot(seeds.patches[s].normal) > 0.f;
    crease.point = here + q;
    // Further away it is the corner of a rounded edge, not of a sharp one.
    return q.dot(q) < 0.65f * 0.65f;
}

using Creases = std::vector<std::pair<std::uint32_t, Crease>>; // of a block, by seed

void moveOntoCrease(SurfaceSeeds& seeds, std::uint32_t s, const Crease& crease) {
    PointBlocks& points = seeds.points;
    // The point may leave its block by a little; its block's number stays.
    points.x[s] = crease.point.x;
    points.y[s] = crease.point.y;
    points.z[s] = crease.point.z;
    SurfacePatch& patch = seeds.patches[s];
    patch.crease = true;
    patch.convex = crease.convex;
    // Between the faces' normals, so that a ball that stands on the edge cuts neither face nor the edge itself.
    patch.normal = Imath::V3f(0.f);
    for (int face = 0; face < crease.faces; ++face)
        patch.normal += crease.normal[face];
    patch.normal.normalize();
    patch.shape = {crease.along.x, crease.along.y, crease.along.z, 0.f, 0.f, 0.f};
    patch.reach = crease.reach;
}

// A seed beside a crease (`apart` from it to the crease): its patch ends there; where it lies on one of the crease's
// faces it is flat as that is, and where it lies on a chord it belongs onto the crease itself.
void fitBeside(const Crease& crease, const Imath::V3f& apart, SurfaceSeeds& seeds, std::uint32_t s) {
    constexpr float onFace = 0.03f, underFace = 0.12f, flat = 0.03f, sharp = 0.3f, alike = 0.8f;
    SurfacePatch& patch = seeds.patches[s];
    const float bentness = patch.bentness();
    const Imath::V3f across = apart - crease.along * apart.dot(crease.along);
    if (bentness >= flat) {
        const bool loose = bentness > sharp;
        const float side = crease.convex ? 1.f : -1.f; // on which a chord lies
        int on = -1;
        float least = loose ? underFace : onFace;
        for (int face = 0; face < crease.faces; ++face) {
            const float under = side * apart.dot(crease.normal[face]);
            if (patch.normal.dot(crease.normal[face]) > alike && under > -onFace && under < least) {
                least = under;
                on = face;
            }
        }
        PointBlocks& points = seeds.points;
        if (on >= 0) {
            patch.normal = crease.normal[on];
            patch.shape.fill(0.f);
            points.x[s] += patch.normal.x * side * least;
            points.y[s] += patch.normal.y * side * least;
            points.z[s] += patch.normal.z * side * least;
        } else if (loose && across.dot(across) < 0.65f * 0.65f && side * across.dot(patch.normal) > 0.f) {
            Crease here = crease;
            here.point = Imath::V3f(points.x[s], points.y[s], points.z[s]) + across;
            moveOntoCrease(seeds, s, here);
            return;
        }
    }
    if (crease.convex)
        patch.reach = std::min(patch.reach, across.length());
}

} // namespace

void sharpenCreases(SurfaceSeeds& seeds) {
    const PointBlocks& points = seeds.points;
    std::vector<Creases> found(points.blocks.size());
    tbb::parallel_for(std::size_t(0), points.blocks.size(), [&](std::size_t n) {
        Crease crease;
        for (std::uint32_t s = points.blocks[n].begin; s < points.blocks[n].end; ++s)
            if (seeds.patches[s].bentness() > 0.5f && findCrease(seeds, s, crease))
                found[n].emplace_back(s, crease);
    });
    tbb::parallel_for(std::size_t(0), points.blocks.size(), [&](std::size_t n) {
        for (const auto& [s, crease] : found[n])
            moveOntoCrease(seeds, s, crease);
    });
    tbb::parallel_for(std::size_t(0), points.blocks.size(), [&](std::size_t n) {
        const openvdb::Coord& block = points.blocks[n].block;
        for (int around = 0; around < 27; ++around) {
            const openvdb::Coord step(around / 9 - 1, around / 3 % 3 - 1, around % 3 - 1);
            const std::int32_t other = points.lattice.at(block + step);
            if (other < 0 || found[other].empty())
                continue;
            const Imath::V3f shift = Imath::V3f(float(step.x()), float(step.y()), float(step.z())) * 8.f;
            for (std::uint32_t s = points.blocks[n].begin; s < points.blocks[n].end; ++s) {
                if (seeds.patches[s].crease)
                    continue;
                const Imath::V3f here(points.x[s], points.y[s], points.z[s]);
                for (const auto& [c, crease] : found[other]) {
                    const Imath::V3f apart = crease.point + shift - here;
                    if (apart.dot(apart) <= 4.f && !seeds.patches[s].crease)
                        fitBeside(crease, apart, seeds, s);
                }
            }
        }
    });
}

} // namespace patina
