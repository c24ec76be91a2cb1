#include "volume/region_voxelize.h"

#include "base/errors.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"
#include "volume/unsigned_band.h"

#include <fmt/format.h>
#include <openvdb/tools/Prune.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace patina {

using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

namespace {

// Crossings of a ray from the point to infinity: those that leave the metal minus those that enter it.
int windingAlong(const RayScene& whole, const V3f& origin, const V3f& direction) {
    int winding = 0;
    float from = 0.f;
    for (int hits = 0; hits < 10000; ++hits) {
        const auto hit = whole.intersect(origin, direction, from);
        if (!hit)
            break;
        winding += hit->geometricNormal.dot(direction) > 0.f ? 1 : -1;
        from = std::nextafter(hit->distance * (1.f + 1e-6f), std::numeric_limits<float>::max());
    }
    return winding;
}

// Which side of the piece a point is on. Where its closest point lies within a triangle, that triangle's plane tells.
// At edges and corners a ray to the middle of the triangle meets the surface for the first time on the side it is on.
double sideOf(const ClosedSurface& piece, const RayScene& scene, const V3d& x, const SurfacePoint& closest) {
    const V3i& corners = piece.triangles[closest.triangle];
    const V3d a(piece.positions[corners[0]]), b(piece.positions[corners[1]]), c(piece.positions[corners[2]]);
    const V3d normal = (b - a).cross(c - a);
    constexpr float edge = 1e-4f;
    if (closest.u <= edge || closest.v <= edge || closest.u + closest.v >= 1.f - edge) {
        const V3d way = (a + b + c) / 3.0 - x;
        if (way.length2() > 0.0) {
            const auto hit = scene.intersect(V3f(x), V3f(way), 0.f, 1.0001f);
            if (hit)
                return hit->geometricNormal.dot(V3f(way)) > 0.f ? -1.0 : 1.0;
        }
    }
    return (x - a).dot(normal) < 0.0 ? -1.0 : 1.0;
}

// What lies beyond the band within a leaf: as the voxels next to it. Between the sides the band separates inside from
// outside; beyond them it does not, so these come last and only carry on what is there.
template <typename IsInside>
void spreadSigns(FloatLeaf& leaf, const openvdb::CoordBBox& sides, float outer, IsInside&& isInside) {
    std::vector<int> queue;
    std::array<char, FloatLeaf::SIZE> known{}, between{};
    for (int at = 0; at < int(FloatLeaf::SIZE); ++at) {
        between[at] = sides.isInside(leaf.offsetToGlobalCoord(static_cast<openvdb::Index>(at)));
        if (leaf.isValueOn(static_cast<openvdb::Index>(at))) {
            known[at] = 1;
            queue.push_back(at);
        }
    }
    const auto spread = [&](bool beyond) {
        for (std::size_t next = 0; next < queue.size(); ++next) {
            const int at = queue[next];
            const float value = std::copysign(outer, leaf.getValue(static_cast<openvdb::Index>(at)));
            const auto visit = [&](bool there, int other) {
                if (!there || known[other] || (!beyond && !between[other]))
                    return;
                known[other] = 1;
                leaf.setValueOnly(static_cast<openvdb::Index>(other), value);
                queue.push_back(other);
            };
            const int x = at >> 6, y = (at >> 3) & 7, z = at & 7;
            visit(x > 0, at - 64);
            visit(x < 7, at + 64);
            visit(y > 0, at - 8);
            visit(y < 7, at + 8);
            visit(z > 0, at - 1);
            visit(z < 7, at + 1);
        }
    };
    spread(false);
    for (int at = 0; at < int(FloatLeaf::SIZE); ++at) {
        if (!between[at] || known[at])
            continue;
        known[at] = 1;
        const bool inside = isInside(leaf.offsetToGlobalCoord(static_cast<openvdb::Index>(at)));
        leaf.setValueOnly(static_cast<openvdb::Index>(at), inside ? -outer : outer);
        queue.push_back(at);
        spread(false);
    }
    spread(true);
}

// The blocks of 8³ voxels without a leaf are wholly inside or outside; those that touch each other are the same. One
// question per connected group settles them. Those that a side runs through are asked one by one: the band is cut off in
// them, so they separate nothing, which would lead the library's flood fill astray as well.
template <typename IsInside>
void fillInside(openvdb::FloatGrid& grid, const IndexSpace& space, const openvdb::CoordBBox& sides, double voxelSize,
                float outer, IsInside&& isInside) {
    const openvdb::Coord first = sides.min() >> 3, last = sides.max() >> 3;
    const V3i low(first.x(), first.y(), first.z()), size(V3i(last.x(), last.y(), last.z()) - low + V3i(1));
    const auto isCut = [&](const V3i& b) {
        const V3i o = (b + low) * 8;
        const openvdb::Coord corner(o.x, o.y, o.z);
        return !sides.isInside(openvdb::CoordBBox(corner, corner.offsetBy(7)));
    };
    const auto middleOf = [&](const V3i& b) {
        const V3i o = (b + low) * 8;
        V3d middle = space.position({o.x, o.y, o.z}) + V3d(3.5);
        const V3d from = space.position(sides.min()), to = space.position(sides.max());
        for (int i = 0; i < 3; ++i)
            middle[i] = std::clamp(middle[i], from[i], to[i]);
        return middle * voxelSize;
    };
    const auto indexOf = [&](const V3i& b) { return (std::size_t(b.x) * size.y + b.y) * size.z + b.z; };
    enum State : char { unknown, leaf, seen };
    std::vector<char> state(std::size_t(size.x) * size.y * size.z, unknown);
    for (const FloatLeaf* node : leavesOf(std::as_const(grid.tree()))) {
        const openvdb::Coord o = node->origin() >> 3;
        const V3i b = V3i(o.x(), o.y(), o.z()) - low;
        if (b.x >= 0 && b.y >= 0 && b.z >= 0 && b.x < size.x && b.y < size.y && b.z < size.z)
            state[indexOf(b)] = leaf;
    }
    std::vector<V3i> group;
    for (int i = 0; i < size.x; ++i)
        for (int j = 0; j < size.y; ++j)
            for (int k = 0; k < size.z; ++k) {
                const V3i seed(i, j, k);
                if (state[indexOf(seed)] != unknown)
                    continue;
                group.assign(1, seed);
                state[indexOf(seed)] = seen;
                for (std::size_t next = 0; next < group.size() && !isCut(seed); ++next)
                    for (int d = 0; d < 6; ++d) {
                        V3i b = group[next];
                        b[d / 2] += d % 2 ? 1 : -1;
                        if (b[d / 2] < 0 || b[d / 2] >= size[d / 2] || state[indexOf(b)] != unknown || isCut(b))
                            continue;
                        state[indexOf(b)] = seen;
                        group.push_back(b);
                    }
                if (!isInside(middleOf(seed)))
                    continue;
                for (const V3i& b : group) {
                    const V3i o = (b + low) * 8;
                    grid.tree().addTile(1, openvdb::Coord(o.x, o.y, o.z), -outer, false);
                }
            }
}

} // namespace

bool isInside(const RayScene& whole, const V3f& point) {
    // Two directions of no symmetry; a third decides where a ray slipped through a crack or met an edge twice.
    static const V3f directions[3] = {V3f(0.5377f, 0.6183f, 0.5732f), V3f(-0.7013f, 0.3141f, -0.6399f),
                                      V3f(0.1733f, -0.8867f, 0.4286f)};
    const bool first = windingAlong(whole, point, directions[0]) != 0;
    const bool second = windingAlong(whole, point, directions[1]) != 0;
    return first == second ? first : windingAlong(whole, point, directions[2]) != 0;
}

void settleSides(SurfaceMesh& piece, const RayScene& whole, double voxelSize) {
    enum Fate : char { keep, turn, drop };
    std::vector<char> fate(piece.triangles.size(), keep);
    tbb::parallel_for(std::size_t(0), fate.size(), [&](std::size_t t) {
        const V3i& c = piece.triangles[t];
        const V3d a(piece.positions[c[0]]), b(piece.positions[c[1]]), d(piece.positions[c[2]]);
        const V3d middle = (a + b + d) / 3.0;
        const V3d normal = (b - a).cross(d - a).normalized();
        // A cage's piece is finer than the whole it is asked in, and lies a little off it.
        const auto off = whole.closest(V3f(middle), static_cast<float>(64.0 * voxelSize));
        const double away = 0.25 * voxelSize + (off ? 2.0 * off->distance : 0.0);
        const bool in = isInside(whole, V3f(middle - normal * away)), out = isInside(whole, V3f(middle + normal * away));
        fate[t] = in == out ? drop : out ? turn : keep;
    });
    // A surface without an inside (a sheet among closed parts) is better kept than lost.
    if (std::find_if(fate.begin(), fate.end(), [](char f) { return f != drop; }) == fate.end())
        return;
    if (std::all_of(fate.begin(), fate.end(), [](char f) { return f == keep; }))
        return;
    SurfaceMesh settled = piece;
    settled.triangles.clear();
    settled.triangleUvs.clear();
    settled.triangleFaces.clear();
    std::vector<char> turned(piece.positions.size(), 0);
    for (std::size_t t = 0; t < fate.size(); ++t) {
        if (fate[t] == drop)
            continue;
        V3i corners = piece.triangles[t], uvs = piece.hasUvs() ? piece.triangleUvs[t] : V3i(0);
        if (fate[t] == turn) {
            std::swap(corners[1], corners[2]);
            std::swap(uvs[1], uvs[2]);
            for (int c = 0; c < 3; ++c)
                turned[corners[c]] = 1;
        }
        settled.triangles.push_back(corners);
        if (piece.hasUvs())
            settled.triangleUvs.push_back(uvs);
        settled.triangleFaces.push_back(piece.triangleFaces[t]);
    }
    for (std::size_t v = 0; v < turned.size(); ++v)
        if (turned[v])
            settled.normals[v] = -settled.normals[v];
    piece = std::move(settled);
}

LayerVolume voxelizeRegion(const ClosedSurface& piece, const Region& region, const VoxelizeOptions& options,
                           Progress& progress) {
    const double voxelSize = options.scale.voxelSize;
    const double widest = std::max(options.exteriorBand, options.interiorBand) + 1.0;
    auto grids = std::make_unique<NestGrids>();
    // The library finds the band; signs and distances are ours.
    grids->base = unsignedBand(piece, voxelSize, static_cast<float>(widest), progress);
    grids->space = IndexSpace(grids->base->transform());
    progress.checkpoint();
    grids->interiorBand = options.interiorBand;
    grids->exteriorBand = options.exteriorBand;

    const RayScene scene(piece.positions, piece.triangles);
    const Imath::Box3i sides = region.voxelSides();
    grids->sides = grids->space.index(sides);
    const auto outer = static_cast<float>(options.exteriorBand * voxelSize);
    const auto inner = static_cast<float>(options.interiorBand * voxelSize);
    const auto leaves = leavesOf(grids->base->tree());
    std::vector<char> inside(leaves.size(), 0);
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        if (progress.cancelled())
            return;
        for (auto voxel = leaves[n]->beginValueOn(); voxel; ++voxel) {
            const openvdb::Coord c = voxel.getCoord();
            const V3d x = grids->space.position(c) * voxelSize;
            const auto closest = scene.closest(V3f(x), 1.05f * *voxel + static_cast<float>(voxelSize));
            if (!grids->sides.isInside(c) || !closest) {
                voxel.setValueOff();
                continue;
            }
            const V3i& t = piece.triangles[closest->point.triangle];
            const double u = closest->point.u, v = closest->point.v;
            const V3d p = V3d(piece.positions[t[0]]) * (1.0 - u - v) + V3d(piece.positions[t[1]]) * u +
                          V3d(piece.positions[t[2]]) * v;
            const double side = sideOf(piece, scene, x, closest->point);
            const auto distance = static_cast<float>((x - p).length());
            if (distance > (side < 0.0 ? inner : outer)) {
                leaves[n]->setValueOff(voxel.pos(), static_cast<float>(side) * outer);
                continue;
            }
            voxel.setValue(static_cast<float>(side) * distance);
            if (side < 0.0)
                inside[n] = 1;
        }
    });
    progress.checkpoint();
    if (std::find(inside.begin(), inside.end(), 1) == inside.end())
        throw ModelError("model", fmt::format("nothing of it is inside at a voxel size of {:.4g} scene units", region.voxelSize),
                         "use smaller voxels (--voxels or --voxel-size), or check the model's faces");
    openvdb::tools::pruneInactive(grids->base->tree());
    grids->base->setGridClass(openvdb::GRID_LEVEL_SET);
    grids->base->tree().root().setBackground(outer, /*updateChildNodes=*/true);
    const auto kept = leavesOf(grids->base->tree());
    const auto isInPiece = [&](const V3d& x) {
        const auto closest = scene.closest(V3f(x));
        return closest && sideOf(piece, scene, x, closest->point) < 0.0;
    };
    tbb::parallel_for(std::size_t(0), kept.size(), [&](std::size_t n) {
        spreadSigns(*kept[n], grids->sides, outer, [&](const openvdb::Coord& c) {
            return isInPiece(grids->space.position(c) * voxelSize);
        });
    });
    fillInside(*grids->base, grids->space, grids->sides, voxelSize, outer, isInPiece);
    const auto place = grids->space.transform(voxelSize, region.origin() * region.magnification);
    grids->base->setTransform(place);

    auto tree = std::make_shared<openvdb::Int32Tree>(grids->base->tree(), 0, openvdb::TopologyCopy());
    grids->material = openvdb::Int32Grid::create(tree);
    grids->material->setTransform(place->copy());
    LayerVolume volume(options.scale, options.metal, std::move(grids));
    volume.provenance.region = region.text();
    updateMaterialIds(volume);
    return volume;
}

} // namespace patina
