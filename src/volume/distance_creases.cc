#include "volume/distance_creases.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace patina {

namespace {

// Voxels from a crease within which a seed may belong onto it.
constexpr float nearCrease = 0.65f;

// A point of a face and the outward unit normal there.
struct FacePoint {
    Imath::V3f foot, normal;
};

// A face beside a crease, as the parabola of one of its seeds goes on.
struct Face {
    Imath::V3f place;
    SurfacePatch patch;

    FacePoint under(const Imath::V3f& q) const {
        const Imath::V3f apart = q - place, u = apart - patch.normal * apart.dot(patch.normal), bent = patch.bend(u);
        return {place + u - patch.normal * (0.5f * u.dot(bent)), (patch.normal + bent).normalized()};
    }
    /// Of q above it, along the seed's normal.
    float height(const Imath::V3f& q) const {
        const Imath::V3f apart = q - place;
        const float above = apart.dot(patch.normal);
        const Imath::V3f u = apart - patch.normal * above;
        return above + 0.5f * u.dot(patch.bend(u));
    }
};

// The faces that meet near a seed on a sharp crease, and where they do.
struct Crease {
    Imath::V3f point;
    Imath::V3f along;   ///< unit; zero where three faces meet
    float reach;        ///< how far it goes on both ways
    Imath::V3f face[2]; ///< normals there of the first two
    Face faces[3];      ///< measured from `point`; the third, where there is one, makes a corner or ends the crease
    enum class Third { none, ends, makesCorner } third;
    bool convex;

    bool isCorner() const { return along == Imath::V3f(0.f); }
    int count() const { return isCorner() ? 3 : 2; } ///< of the faces that meet
};

// The point nearest to the origin that minimises the squared distances to some planes normal · (p - foot) = 0 (Garland
// and Heckbert's quadric): (sum n n^T + e) q = sum n (n · foot), where e keeps q near the origin along an edge.
Imath::V3f meetingPoint(const FacePoint* planes, int count) {
    constexpr double e = 1e-4;
    double A[3][3] = {{e, 0.0, 0.0}, {0.0, e, 0.0}, {0.0, 0.0, e}}, r[3] = {};
    for (int i = 0; i < count; ++i) {
        const Imath::V3f& n = planes[i].normal;
        const double d = double(n.dot(planes[i].foot));
        for (int x = 0; x < 3; ++x) {
            r[x] += double(n[x]) * d;
            for (int y = 0; y < 3; ++y)
                A[x][y] += double(n[x]) * double(n[y]);
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

// Where the first faces of a crease meet, nearest to `from`, by planes that touch them; their normals and the edge's
// direction there.
Imath::V3f meetFaces(const Face* faces, int count, const Imath::V3f& from, Imath::V3f* normals) {
    Imath::V3f q = from;
    FacePoint planes[3];
    for (int step = 0; step < 3; ++step) {
        for (int i = 0; i < count; ++i) {
            planes[i] = faces[i].under(q);
            planes[i].foot -= from;
        }
        q = from + meetingPoint(planes, count);
    }
    for (int i = 0; i < count; ++i)
        normals[i] = planes[i].normal;
    return q;
}

// Puts a crease where its faces meet next to `from`. \return false where they do not
bool placeCrease(Crease& crease, const Imath::V3f& from) {
    Imath::V3f normals[3];
    crease.point = meetFaces(crease.faces, 2, from, normals);
    crease.face[0] = normals[0];
    crease.face[1] = normals[1];
    const Imath::V3f along = normals[0].cross(normals[1]);
    if (!(along.dot(along) > 0.01f))
        return false;
    crease.along = along.normalized();
    crease.reach = SurfacePatch::furthestReach;
    if (crease.third == Crease::Third::none)
        return true;
    // Where along the edge the third face cuts it: a corner there, or an edge that ends there.
    const FacePoint third = crease.faces[2].under(crease.point);
    const float end = third.normal.dot(third.foot - crease.point) / third.normal.dot(crease.along);
    if (crease.third == Crease::Third::makesCorner && std::abs(end) < 0.5f) {
        crease.point = meetFaces(crease.faces, 3, from, normals);
        crease.along = Imath::V3f(0.f);
    } else {
        crease.reach = std::min(crease.reach, std::abs(end));
    }
    return true;
}

// Whether a patch is so bent that it may be a chord; a blunt convex edge bends it less.
bool mayLieOnCrease(const SurfacePatch& patch) {
    const bool outward = patch.shape[0] + patch.shape[3] + patch.shape[5] > 0.f;
    return patch.bentness() > (outward ? 0.3f : 0.5f);
}

// Calls visit(place from the seed, patch) for the flat seeds around one.
template <typename Visit>
void forFlatSeeds(const SurfaceSeeds& seeds, std::uint32_t s, float reach, const Visit& visit) {
    constexpr float flat = 0.15f;
    const PointBlocks& points = seeds.points;
    const openvdb::Coord& home = points.blocks[points.blockOf[s]].block;
    const Imath::V3f here(points.x[s], points.y[s], points.z[s]);
    int from[3], to[3];
    for (int axis = 0; axis < 3; ++axis) {
        from[axis] = here[axis] < reach ? -1 : 0;
        to[axis] = here[axis] > 8.f - reach ? 1 : 0;
    }
    for (int i = from[0]; i <= to[0]; ++i)
        for (int j = from[1]; j <= to[1]; ++j)
            for (int k = from[2]; k <= to[2]; ++k) {
                const std::int32_t number = points.lattice.at(home.offsetBy(i, j, k));
                if (number < 0)
                    continue;
                const Imath::V3f origin(8.f * float(i), 8.f * float(j), 8.f * float(k));
                for (std::uint32_t o = points.blocks[number].begin; o < points.blocks[number].end; ++o) {
                    const Imath::V3f apart = origin + Imath::V3f(points.x[o], points.y[o], points.z[o]) - here;
                    if (apart.dot(apart) <= reach * reach && seeds.patches[o].bentness() <= flat)
                        visit(apart, seeds.patches[o]);
                }
            }
}

// Values of a level set say where faces are, but no cell knows the edge between two: its seed lies on a chord. Where a
// seed is so curved that it can only be on an edge, the faces of the flat seeds around it are intersected.
bool findCrease(const SurfaceSeeds& seeds, std::uint32_t s, Crease& crease) {
    constexpr float reach = 2.2f, furthest = 3.f;
    constexpr int most = 64;
    std::array<Imath::V3f, most> normals, places;
    std::array<const SurfacePatch*, most> patches;
    int count = 0;
    forFlatSeeds(seeds, s, reach, [&](const Imath::V3f& apart, const SurfacePatch& patch) {
        if (count == most)
            return;
        normals[count] = patch.normal;
        patches[count] = &patch;
        places[count++] = apart;
    });
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
    // Their planes tell whether it is worth while to look closer.
    const FacePoint planes[2] = {{places[a], normals[a]}, {places[b], normals[b]}};
    if (meetingPoint(planes, 2).length() > 2.f * nearCrease)
        return false;
    const Imath::V3f along = normals[a].cross(normals[b]).normalized();
    const int c = nearestWhere([&](int i) { return std::abs(normals[i].dot(along)) > 0.3f; });
    // Seeds beside the crease are off and turned by it: of each face that one goes on, curved or flat, from which the
    // others are least far.
    const auto faceOf = [&](int like) {
        constexpr float off = 0.05f;
        std::array<Imath::V3f, most> on;
        std::array<int, most> number;
        int size = 0;
        for (int i = 0; i < count; ++i)
            if (normals[i].dot(normals[like]) > 0.97f) {
                on[size] = places[i];
                number[size++] = i;
            }
        Face best{places[like], *patches[like]};
        float least = std::numeric_limits<float>::max();
        for (int i = 0; i < size; ++i)
            for (const bool isFlat : {false, true}) {
                Face face{on[i], *patches[number[i]]};
                if (isFlat)
                    face.patch.shape.fill(0.f);
                float cost = 1e-3f * on[i].length() + 0.02f * float(size) * patches[number[i]]->bentness();
                for (int j = 0; j < size && cost < least; ++j)
                    cost += std::min(std::abs(face.height(on[j])), off);
                if (cost < least) {
                    least = cost;
                    best = face;
                }
            }
        return best;
    };
    crease.faces[0] = faceOf(a);
    crease.faces[1] = faceOf(b);
    crease.third = c >= 0 ? Crease::Third::makesCorner : Crease::Third::none;
    crease.faces[2] = c >= 0 ? faceOf(c) : crease.faces[1];
    if (!placeCrease(crease, Imath::V3f(0.f)))
        return false;
    const Imath::V3f q = crease.point;
    // Further away it is the corner of a rounded edge, not of a sharp one.
    if (q.dot(q) >= nearCrease * nearCrease)
        return false;
    if (c < 0) { // what is further away may end it
        float nearest = 2.f * SurfacePatch::furthestReach;
        forFlatSeeds(seeds, s, furthest, [&](const Imath::V3f& apart, const SurfacePatch& patch) {
            const float lean = patch.normal.dot(crease.along);
            const float end = std::abs(patch.normal.dot(apart - q) / lean);
            if (std::abs(lean) > 0.3f && end < nearest) {
                nearest = end;
                crease.third = Crease::Third::ends;
                crease.faces[2] = {apart, patch};
            }
        });
        crease.reach = std::min(crease.reach, nearest);
    }
    crease.convex = q.dot(seeds.patches[s].normal) > 0.f;
    crease.point = Imath::V3f(seeds.points.x[s], seeds.points.y[s], seeds.points.z[s]) + q;
    for (Face& face : crease.faces)
        face.place -= q;
    return true;
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
    patch.normal = crease.face[0] + crease.face[1];
    if (crease.isCorner())
        patch.normal += crease.faces[2].under(Imath::V3f(0.f)).normal;
    patch.normal.normalize();
    const Imath::V3f face = crease.isCorner() ? Imath::V3f(0.f) : crease.face[0];
    patch.shape = {crease.along.x, crease.along.y, crease.along.z, face.x, face.y, face.z};
    patch.reach = crease.reach;
}

// What becomes of a seed beside creases.
struct Beside {
    enum class Kind { asItIs, onFace, onCrease } kind = Kind::asItIs;
    float apart = std::numeric_limits<float>::max(); ///< to the crease that says so, squared
    float reach = SurfacePatch::furthestReach;       ///< to the nearest convex crease
    Imath::V3f foot;                                 ///< from the seed
    SurfacePatch patch;
    Crease crease; ///< from the seed
};

// Asks one crease at `x` from the seed: a patch ends there; where it lies on one of the crease's faces it is as that
// is, and where it lies on a chord it belongs onto the crease itself.
void askCrease(const Crease& crease, const Imath::V3f& x, const SurfacePatch& patch, Beside& beside) {
    constexpr float onFace = 0.03f, underFace = 0.12f, unlike = 0.03f, sharp = 0.3f, alike = 0.8f;
    const float aside = x.dot(crease.along), distance = (x - crease.along * aside).length();
    if (crease.convex && std::abs(aside) < 1.f) // nearer pieces know better where a curved crease is
        beside.reach = std::min(beside.reach, distance);
    const float apart = x.dot(x);
    if (apart >= beside.apart)
        return;
    // Where the lattice lies evenly to both faces a chord is not even bent.
    const auto turnedFrom = [&](int i) { return patch.normal.dot(crease.faces[i].under(-x).normal) < 0.95f; };
    const bool turned = turnedFrom(0) && turnedFrom(1) && (crease.count() < 3 || turnedFrom(2));
    const bool loose = turned || patch.bentness() > sharp;
    const float side = crease.convex ? 1.f : -1.f; // on which a chord lies
    int on = -1;
    float least = loose || (crease.convex && distance < nearCrease) ? underFace : onFace;
    for (int i = 0; i < crease.count(); ++i) {
        const FacePoint at = crease.faces[i].under(-x);
        const float under = side * (at.foot + x).dot(at.normal);
        if (patch.normal.dot(at.normal) > alike && under > -onFace && under < least) {
            least = under;
            on = i;
        }
    }
    if (on >= 0) {
        beside.apart = apart;
        SurfacePatch difference = patch;
        for (int k = 0; k < 6; ++k)
            difference.shape[k] -= crease.faces[on].patch.shape[k];
        const FacePoint at = crease.faces[on].under(-x);
        const bool knows = difference.bentness() < unlike && patch.normal.dot(at.normal) > 0.9995f;
        beside.kind = knows ? Beside::Kind::asItIs : Beside::Kind::onFace;
        beside.foot = at.foot + x;
        beside.patch = crease.faces[on].patch;
        beside.patch.normal = at.normal;
    } else if (loose && distance < nearCrease && side * (x - crease.along * aside).dot(patch.normal) > 0.f) {
        Crease here = crease;
        here.point = x;
        for (Face& face : here.faces)
            face.place += x;
        if (!crease.isCorner() && !placeCrease(here, Imath::V3f(0.f)))
            return;
        beside.kind = Beside::Kind::onCrease;
        beside.crease = here;
        beside.apart = apart;
    }
}

void settle(const Beside& beside, SurfaceSeeds& seeds, std::uint32_t s) {
    PointBlocks& points = seeds.points;
    const Imath::V3f here(points.x[s], points.y[s], points.z[s]);
    SurfacePatch& patch = seeds.patches[s];
    if (beside.kind == Beside::Kind::onCrease) {
        Crease crease = beside.crease;
        crease.point += here;
        for (Face& face : crease.faces)
            face.place -= beside.crease.point;
        moveOntoCrease(seeds, s, crease);
        return;
    }
    if (beside.kind == Beside::Kind::onFace) {
        const float reach = patch.reach;
        patch = beside.patch;
        patch.reach = reach;
        points.x[s] += beside.foot.x;
        points.y[s] += beside.foot.y;
        points.z[s] += beside.foot.z;
    }
    patch.reach = std::min(patch.reach, beside.reach);
}

} // namespace

void sharpenCreases(SurfaceSeeds& seeds) {
    const PointBlocks& points = seeds.points;
    std::vector<Creases> found(points.blocks.size());
    tbb::parallel_for(std::size_t(0), points.blocks.size(), [&](std::size_t n) {
        Crease crease;
        for (std::uint32_t s = points.blocks[n].begin; s < points.blocks[n].end; ++s)
            if (mayLieOnCrease(seeds.patches[s]) && findCrease(seeds, s, crease))
                found[n].emplace_back(s, crease);
    });
    tbb::parallel_for(std::size_t(0), points.blocks.size(), [&](std::size_t n) {
        for (const auto& [s, crease] : found[n])
            moveOntoCrease(seeds, s, crease);
    });
    tbb::parallel_for(std::size_t(0), points.blocks.size(), [&](std::size_t n) {
        const openvdb::Coord& block = points.blocks[n].block;
        const std::uint32_t begin = points.blocks[n].begin;
        std::vector<Beside> beside;
        for (int around = 0; around < 27; ++around) {
            const openvdb::Coord step(around / 9 - 1, around / 3 % 3 - 1, around % 3 - 1);
            const std::int32_t other = points.lattice.at(block + step);
            if (other < 0 || found[other].empty())
                continue;
            beside.resize(points.blocks[n].end - begin);
            const Imath::V3f shift = Imath::V3f(float(step.x()), float(step.y()), float(step.z())) * 8.f;
            for (std::uint32_t s = begin; s < points.blocks[n].end; ++s) {
                if (seeds.patches[s].crease)
                    continue;
                const Imath::V3f here(points.x[s], points.y[s], points.z[s]);
                for (const auto& [c, crease] : found[other]) {
                    const Imath::V3f apart = crease.point + shift - here;
                    if (apart.dot(apart) <= 4.f)
                        askCrease(crease, apart, seeds.patches[s], beside[s - begin]);
                }
            }
        }
        for (std::size_t i = 0; i < beside.size(); ++i)
            if (const auto s = static_cast<std::uint32_t>(begin + i); !seeds.patches[s].crease)
                settle(beside[i], seeds, s);
    });
}

} // namespace patina
