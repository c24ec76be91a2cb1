#include "volume/surface_binding.h"

#include "volume/material_ids.h"
#include "volume/nest_sampler.h"

#include <openvdb/tools/Prune.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace patina {

namespace {

// Triangles with longer edges are asked piece by piece.
constexpr double largeVoxels = 8.0, pieceVoxels = 4.0;

// How far to look for a voxel's closest point: phi_0 is the distance to the model, or to a hidden face, or some thousandths
// too much.
float nearestWithin(float phi, double voxelSize) {
    return static_cast<float>(1.0005 * std::abs(phi) + 0.02 * voxelSize);
}

// A film on a sheet reaches as far down the rim: a voxel would do for the cells that the edge itself runs through.
constexpr double rimVoxels = 2.0;

enum Sight : char { seen, buried, partly };

// A triangle and where its corners are in the one it was cut from.
struct Part {
    Imath::V3d corners[3];
    Imath::V2d uvs[3];

    double longestEdge() const {
        return std::max({(corners[0] - corners[1]).length(), (corners[1] - corners[2]).length(),
                         (corners[2] - corners[0]).length()});
    }
    // The four triangles between the corners and the edges' middles.
    Part quarter(int i) const {
        const auto middle = [](const auto& a, const auto& b) { return (a + b) * 0.5; };
        Part part;
        for (int c = 0; c < 3; ++c) {
            const int a = i < 3 ? i : (c + 1) % 3, b = i < 3 ? c : (c + 2) % 3;
            part.corners[c] = middle(corners[a], corners[b]);
            part.uvs[c] = middle(uvs[a], uvs[b]);
        }
        return part;
    }
};

// Whether there is metal on both sides of a triangle, three quarters of a voxel from its corners and its middle.
// (Both sides are asked, so that a model turned inside out keeps its surface.)
bool isBuried(const NestSampler& sampler, const Part& part, double voxelSize) {
    const Imath::V3d &a = part.corners[0], &b = part.corners[1], &c = part.corners[2];
    const Imath::V3d normal = (b - a).cross(c - a).normalized() * 0.75;
    for (const Imath::V3d& p : {(a + b + c) / 3.0, a, b, c})
        for (const double side : {1.0, -1.0})
            if (sampler.value(0, sampler.locate(p / voxelSize + normal * side)) > 0.0)
                return false;
    return true;
}

// The pieces of a part that are seen, each as large as can be, are added to `pieces`.
Sight examine(const NestSampler& sampler, const Part& part, double voxelSize, double limit, std::vector<Part>& pieces) {
    if (part.longestEdge() <= limit * voxelSize) {
        if (isBuried(sampler, part, voxelSize))
            return buried;
        pieces.push_back(part);
        return seen;
    }
    const std::size_t before = pieces.size();
    int count[3] = {0, 0, 0};
    for (int i = 0; i < 4; ++i)
        ++count[examine(sampler, part.quarter(i), voxelSize, pieceVoxels, pieces)];
    if (count[seen] < 4)
        return count[buried] == 4 ? buried : partly;
    pieces.resize(before);
    pieces.push_back(part);
    return seen;
}

} // namespace

SurfaceBinding::SurfaceBinding(const LayerVolume& volume, const SurfaceMesh& surface, ClosedSurface closed)
    : surface_(&surface), closed_(std::move(closed)), rimReach_(rimVoxels * volume.scale().voxelSize) {
    findVisible(volume);
    rebind(volume);
}

bool SurfaceBinding::findVisible(const LayerVolume& volume) {
    const NestSampler sampler(volume.grids());
    const double voxelSize = volume.scale().voxelSize;
    const std::size_t count = closed_.triangles.size();
    std::vector<char> sight(count);
    std::vector<std::vector<Part>> parts(count);
    tbb::parallel_for(std::size_t(0), count, [&](std::size_t t) {
        const Imath::V3i& c = closed_.triangles[t];
        const Part whole{{Imath::V3d(closed_.positions[c[0]]), Imath::V3d(closed_.positions[c[1]]),
                          Imath::V3d(closed_.positions[c[2]])},
                         {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}};
        sight[t] = examine(sampler, whole, voxelSize, largeVoxels, parts[t]);
        if (sight[t] != partly)
            std::vector<Part>().swap(parts[t]);
    });
    const bool none = std::all_of(sight.begin(), sight.end(), [](char s) { return s == buried; });
    std::vector<int> visible;
    std::vector<Imath::V3i> triangles;
    for (std::size_t t = 0; t < count; ++t)
        if (none || sight[t] == seen) {
            visible.push_back(static_cast<int>(t));
            triangles.push_back(closed_.triangles[t]);
        }
    std::vector<Piece> pieces;
    std::vector<Imath::V3f> positions;
    for (std::size_t t = 0; t < count; ++t)
        for (const Part& part : parts[t]) {
            if (positions.empty())
                positions = closed_.positions;
            const int first = static_cast<int>(positions.size());
            visible.push_back(static_cast<int>(t));
            triangles.emplace_back(first, first + 1, first + 2);
            Piece& piece = pieces.emplace_back();
            for (int c = 0; c < 3; ++c) {
                positions.emplace_back(part.corners[c]);
                piece.corners[c] = Imath::V2f(part.uvs[c]);
            }
        }
    const auto samePieces = [](const Piece& a, const Piece& b) {
        return std::equal(a.corners, a.corners + 3, b.corners);
    };
    if (scene_ && visible == visible_ && pieces.size() == pieces_.size() &&
        std::equal(pieces.begin(), pieces.end(), pieces_.begin(), samePieces))
        return false;
    leafVoxels_.clear(); // closest points of another surface
    visible_ = std::move(visible);
    pieces_ = std::move(pieces);
    scene_.emplace(positions.empty() ? closed_.positions : positions, triangles);
    return true;
}

void SurfaceBinding::countVoxels(const LayerVolume& volume) {
    const auto leaves = leavesOf(std::as_const(volume.grids().base->tree()));
    leafStart_.resize(leaves.size() + 1);
    leafVoxels_.clear();
    leafVoxels_.reserve(leaves.size());
    std::size_t total = 0;
    for (std::size_t n = 0; n < leaves.size(); ++n) {
        const openvdb::Coord& origin = leaves[n]->origin();
        LeafVoxels& voxels = leafVoxels_.emplace_back();
        voxels.origin = {origin.x(), origin.y(), origin.z()};
        for (openvdb::Index word = 0; word < 8; ++word)
            voxels.active[word] = leaves[n]->valueMask().getWord<std::uint64_t>(word);
        leafStart_[n] = total;
        total += leaves[n]->onVoxelCount();
    }
    leafStart_[leaves.size()] = total;
}

void SurfaceBinding::rebind(const LayerVolume& volume) {
    const auto leaves = leavesOf(std::as_const(volume.grids().base->tree()));
    const double voxelSize = volume.scale().voxelSize;
    const IndexSpace& space = volume.grids().space;
    // Metal that only hidden faces are near to has no place in the band: refineBase() takes it out.
    const auto deepest = static_cast<float>((volume.grids().interiorBand + 0.6) * voxelSize);
    // A closest point is a function of the voxel's place alone (see RayScene::closest on ties): those of voxels that
    // were there stay.
    const auto oldVoxels = std::move(leafVoxels_);
    const auto oldStart = std::move(leafStart_);
    const auto oldPoints = std::move(points_);
    std::unordered_map<openvdb::Coord, std::size_t> oldLeaves;
    for (std::size_t n = 0; n < oldVoxels.size(); ++n)
        oldLeaves.emplace(openvdb::Coord(oldVoxels[n].origin.data()), n);
    countVoxels(volume);
    points_.assign(leafStart_.back(), SurfacePoint());
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        std::size_t at = leafStart_[n];
        const auto old = oldLeaves.find(leaves[n]->origin());
        // Where the points of the old leaf's words of voxels begin.
        const LeafVoxels* const before = old == oldLeaves.end() ? nullptr : &oldVoxels[old->second];
        std::size_t wordStart[8];
        if (before) {
            std::size_t start = oldStart[old->second];
            for (int word = 0; word < 8; ++word) {
                wordStart[word] = start;
                start += openvdb::util::CountOn(before->active[word]);
            }
        }
        for (auto voxel = leaves[n]->cbeginValueOn(); voxel; ++voxel, ++at) {
            const openvdb::Index word = voxel.pos() >> 6;
            const std::uint64_t bit = std::uint64_t(1) << (voxel.pos() & 63);
            // What had none may have one in a deeper band.
            if (before && before->active[word] & bit) {
                const SurfacePoint& point =
                    oldPoints[wordStart[word] + openvdb::util::CountOn(before->active[word] & (bit - 1))];
                if (point.triangle >= 0) {
                    points_[at] = point;
                    continue;
                }
            }
            const openvdb::Coord c = voxel.getCoord();
            const float radius = nearestWithin(*voxel, voxelSize);
            const Imath::V3d x = space.position(c) * voxelSize;
            points_[at] = closest(x, radius, *voxel < 0.f ? deepest : std::numeric_limits<float>::infinity());
        }
    });
}

void SurfaceBinding::refineBase(LayerVolume& volume) {
    NestGrids& grids = volume.grids();
    const auto leaves = leavesOf(grids.base->tree());
    const double voxelSize = volume.scale().voxelSize;
    const IndexSpace& space = grids.space;
    const double deepest = (grids.interiorBand + 0.5) * voxelSize;
    const float inside = -grids.base->background();
    std::vector<char> left(points_.size(), 0);
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        std::size_t at = leafStart_[n];
        for (auto voxel = leaves[n]->beginValueOn(); voxel; ++voxel, ++at) {
            const openvdb::Coord c = voxel.getCoord();
            const Imath::V3d x = space.position(c) * voxelSize;
            double distance;
            if (points_[at].triangle >= 0 && !hasBack()) {
                distance = (positionAt(*surface_, points_[at]) - x).length();
            } else {
                const bool metal = *voxel < 0.f;
                auto nearest = scene_->closest(Imath::V3f(x), metal ? float(deepest) + 0.1f * float(voxelSize)
                                                                    : nearestWithin(*voxel, voxelSize));
                if (!nearest && !metal)
                    nearest = scene_->closest(Imath::V3f(x));
                distance = nearest ? nearest->distance : metal ? 2.0 * deepest : std::abs(*voxel);
            }
            if (*voxel < 0.f && distance > deepest) {
                leaves[n]->setValueOff(voxel.pos(), inside);
                left[at] = 1;
            } else {
                voxel.setValue(std::copysign(static_cast<float>(distance), *voxel));
            }
        }
    });
    if (std::find(left.begin(), left.end(), 1) != left.end()) {
        openvdb::tools::pruneLevelSet(grids.base->tree());
        auto tree = std::make_shared<openvdb::Int32Tree>(grids.base->tree(), 0, openvdb::TopologyCopy());
        grids.material->setTree(tree);
        // Bound to the grid as it now is, so that a volume read from a file is bound alike: anew where that changes
        // what can be seen, else by the same points without those of the voxels that left.
        if (findVisible(volume)) {
            rebind(volume);
        } else {
            std::size_t kept = 0;
            for (std::size_t at = 0; at < points_.size(); ++at)
                if (!left[at])
                    points_[kept++] = points_[at];
            points_.resize(kept);
            countVoxels(volume);
        }
    }
    updateMaterialIds(volume);
}

SurfacePoint SurfaceBinding::closest(const Imath::V3d& position, float radius, float widest) const {
    auto found = scene_->closest(Imath::V3f(position), radius);
    if (!found && radius < widest)
        found = scene_->closest(Imath::V3f(position), widest);
    if (!found)
        return {};
    SurfacePoint point = found->point;
    const std::size_t whole = visible_.size() - pieces_.size();
    if (static_cast<std::size_t>(point.triangle) >= whole) {
        const Imath::V2f* c = pieces_[point.triangle - whole].corners;
        const Imath::V2f uv = c[0] * (1.f - point.u - point.v) + c[1] * point.u + c[2] * point.v;
        point.u = uv.x;
        point.v = uv.y;
    }
    point.triangle = visible_[point.triangle];
    return static_cast<std::size_t>(point.triangle) < closed_.frontTriangles ? point : edgeAbove(point);
}

SurfacePoint SurfaceBinding::edgeAbove(const SurfacePoint& onRim) const {
    if (static_cast<std::size_t>(onRim.triangle) < closed_.firstRimTriangle)
        return {};
    const Imath::V3i& c = closed_.triangles[onRim.triangle];
    const Imath::V3d point = Imath::V3d(closed_.positions[c[0]]) * (1.0 - onRim.u - onRim.v) +
                             Imath::V3d(closed_.positions[c[1]]) * onRim.u + Imath::V3d(closed_.positions[c[2]]) * onRim.v;
    const ClosedSurface::OpenSide& side = closed_.openSides[(onRim.triangle - closed_.firstRimTriangle) / 2];
    const Imath::V3i& face = closed_.triangles[side.triangle];
    const Imath::V3d from(closed_.positions[face[side.from]]), along = Imath::V3d(closed_.positions[face[side.to]]) - from;
    const double share = std::clamp((point - from).dot(along) / std::max(along.length2(), 1e-300), 0.0, 1.0);
    if ((point - from - along * share).length() > rimReach_)
        return {};
    float weights[3] = {0.f, 0.f, 0.f};
    weights[side.from] = static_cast<float>(1.0 - share);
    weights[side.to] = static_cast<float>(share);
    return {side.triangle, weights[1], weights[2]};
}

bool SurfaceBinding::behind(const Imath::V3d& position) const {
    const auto found = hasBack() ? scene_->closest(Imath::V3f(position)) : std::nullopt;
    return found && static_cast<std::size_t>(visible_[found->point.triangle]) >= closed_.frontTriangles;
}

bool SurfaceBinding::occluded(const Imath::V3f& origin, const Imath::V3f& direction) const {
    return scene_->occluded(origin, direction, 0.f, std::numeric_limits<float>::infinity());
}

std::optional<RayScene::FaceHit> SurfaceBinding::firstHit(const Imath::V3f& origin, const Imath::V3f& direction,
                                                          float farthest) const {
    return scene_->firstFace(origin, direction, farthest);
}

} // namespace patina
