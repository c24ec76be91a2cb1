#include "script/budget.h"

#include "script/interpreter.h"
#include "volume/index_origin.h"
#include "volume/voxelize.h"

#include <Imath/ImathBox.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace patina {

namespace {

// The layers of a script by their materials, as its operators pile them up.
class Pile {
  public:
    void lay(const std::string& material) {
        if (layers_.empty() || layers_.back() != material)
            layers_.push_back(material);
        most_ = std::max(most_, layers_.size());
    }

    void convert(const std::string& from, const std::string& to) {
        std::vector<std::string> converted;
        const auto add = [&](const std::string& material) {
            if (converted.empty() || converted.back() != material)
                converted.push_back(material);
        };
        std::size_t split = layers_.size();
        for (const std::string& layer : layers_) {
            add(layer);
            if (layer == from && from != to) {
                add(to);
                ++split;
            }
        }
        layers_ = converted;
        most_ = std::max(most_, split); // before neighbours are merged
    }

    std::size_t most() const { return most_; }

  private:
    std::vector<std::string> layers_;
    std::size_t most_ = 0;
};

// Bytes per active voxel that the hungriest operator needs beside the grids.
double workingBytesPerVoxel(const Program& program, const VolumeScale& scale) {
    const double perUm = scale.voxelsPerUm();
    double most = 0.0;
    for (const Statement& statement : program.statements) {
        double bytes = 0.0;
        // Thickness and slope of a shift; the distance and its foot where it is thicker than a voxel.
        const auto shift = [&](double um) { return um * perUm > 1.0 ? 8.0 + 16.0 : 8.0; };
        if (const auto* coat = std::get_if<Coat>(&statement.action))
            bytes = shift(coat->thicknessUm);
        else if (const auto* erode = std::get_if<Erode>(&statement.action))
            bytes = shift(erode->thicknessUm);
        else if (std::holds_alternative<Grow>(statement.action))
            bytes = 6.0;
        else if (const auto* convert = std::get_if<Convert>(&statement.action))
            bytes = convert->map ? 4.0 : 0.0;
        else if (const auto* fill = std::get_if<Fill>(&statement.action))
            bytes = fill->aboveSmoothRadiusUm ? 24.0 : fill->map ? 4.0 : 0.0;
        else if (const auto* polish = std::get_if<Polish>(&statement.action))
            bytes = polish->map || polish->windowUm ? 4.0 : 0.0;
        else if (std::holds_alternative<Offset>(statement.action))
            bytes = 24.0;
        most = std::max(most, bytes);
    }
    return most;
}

// The nodes that a band around a surface needs: leaves of 8³ voxels, and above them nodes of 128³ and 4096³.
struct BandNodes {
    double leaves = 0.0, lower = 0.0, upper = 0.0;
};

// Blocks of 8³ voxels by their place in a box, one bit each.
class BlockMarks {
  public:
    BlockMarks(const Imath::V3i& low, const Imath::V3i& high)
        : low_(low), size_(high - low + Imath::V3i(1)),
          marks_(std::size_t(size_.x) * std::size_t(size_.y) * std::size_t(size_.z)) {}

    void mark(const Imath::V3i& block) {
        const Imath::V3i c = block - low_;
        marks_[(std::size_t(c.x) * std::size_t(size_.y) + std::size_t(c.y)) * std::size_t(size_.z) + std::size_t(c.z)] =
            true;
    }

    BandNodes nodes() const {
        BandNodes nodes;
        std::set<std::array<int, 3>> lower, upper;
        std::size_t at = 0;
        for (int x = 0; x < size_.x; ++x)
            for (int y = 0; y < size_.y; ++y)
                for (int z = 0; z < size_.z; ++z, ++at)
                    if (marks_[at]) {
                        const Imath::V3i b = low_ + Imath::V3i(x, y, z);
                        nodes.leaves += 1.0;
                        lower.insert({b.x >> 4, b.y >> 4, b.z >> 4});
                        upper.insert({b.x >> 9, b.y >> 9, b.z >> 9});
                    }
        nodes.lower = static_cast<double>(lower.size());
        nodes.upper = static_cast<double>(upper.size());
        return nodes;
    }

  private:
    Imath::V3i low_, size_;
    std::vector<bool> marks_;
};

// Where marks would take too much themselves: a slab of thickness w with the unit normal n touches, per area,
// (w + s (|nx| + |ny| + |nz|)) / s³ cubes of side s.
BandNodes slabNodes(const SurfaceMesh& surface, double voxelSize, double width) {
    BandNodes nodes;
    for (const Imath::V3i& t : surface.triangles) {
        const Imath::V3d a(surface.positions[t[0]]), b(surface.positions[t[1]]), c(surface.positions[t[2]]);
        const Imath::V3d twice = (b - a).cross(c - a) / (voxelSize * voxelSize);
        const double area = 0.5 * twice.length();
        const double spread = 0.5 * (std::abs(twice.x) + std::abs(twice.y) + std::abs(twice.z)); // times the area
        const auto cubes = [&](double side) { return (area * width + side * spread) / (side * side * side); };
        nodes.leaves += cubes(8.0);
        nodes.lower += cubes(128.0);
        nodes.upper += cubes(4096.0);
    }
    return nodes;
}

// Marks the blocks that segments across the surface touch, from so many voxels inside to so many outside; a sheet has
// its back and its band behind it.
BandNodes bandNodes(const SurfaceMesh& surface, double voxelSize, double inside, double outside) {
    Imath::Box3f box;
    for (const Imath::V3f& p : surface.positions)
        box.extendBy(p);
    if (box.isEmpty())
        return {};
    const double behind = surface.closed ? inside : sheetBackVoxels + outside;
    const Imath::V3d reach(std::max(behind, outside));
    const Imath::V3i origin =
        indexOriginFor({Imath::V3d(box.min) / voxelSize - reach, Imath::V3d(box.max) / voxelSize + reach});
    const auto blockOf = [voxelSize, origin](const Imath::V3d& p) {
        return Imath::V3i((int(std::floor(p.x / voxelSize + 0.5)) + origin.x) >> 3,
                          (int(std::floor(p.y / voxelSize + 0.5)) + origin.y) >> 3,
                          (int(std::floor(p.z / voxelSize + 0.5)) + origin.z) >> 3);
    };
    const Imath::V3d margin((std::max(behind, outside) + 8.0) * voxelSize);
    const Imath::V3d blocks = (Imath::V3d(box.size()) + margin * 2.0) / (8.0 * voxelSize);
    constexpr double mostMarks = 2147483648.0; // bits: 256 MiB, a cube of 10,000 voxels
    if (!(blocks.x * blocks.y * blocks.z < mostMarks))
        return slabNodes(surface, voxelSize, behind + outside);
    BlockMarks marks(blockOf(Imath::V3d(box.min) - margin), blockOf(Imath::V3d(box.max) + margin));
    constexpr double step = 1.5; // voxels between samples: a leaf that is touched by less than that is rare
    // A sample stands for the voxel it lies in, whose centre must be in the band: half a voxel less at both ends.
    const double most = outside - 0.5, least = 0.5 - behind;
    const int across = std::max(1, static_cast<int>(std::ceil((most - least) / step)));
    for (const Imath::V3i& t : surface.triangles) {
        const Imath::V3d a(surface.positions[t[0]]), b(surface.positions[t[1]]), c(surface.positions[t[2]]);
        const Imath::V3d normal = (b - a).cross(c - a);
        if (!(normal.length2() > 0.0))
            continue;
        const Imath::V3d way = normal.normalized() * voxelSize;
        // Round a sheet's rim the band goes on to the side.
        const Imath::V3d along = (b - a).normalized() * (outside * voxelSize),
                         aside = way.cross(along).normalized() * (outside * voxelSize);
        const Imath::V3d sides[5] = {Imath::V3d(0.0), along, -along, aside, -aside};
        const double longest = std::max({(b - a).length(), (c - a).length(), (c - b).length()}) / voxelSize;
        const int n = std::clamp(static_cast<int>(std::ceil(longest / step)), 1, 4096);
        for (int i = 0; i <= n; ++i)
            for (int j = 0; i + j <= n; ++j) {
                const Imath::V3d p = a + (b - a) * (double(i) / n) + (c - a) * (double(j) / n);
                for (int k = 0; k <= across; ++k)
                    for (int side = 0; side < (surface.closed ? 1 : 5); ++side)
                        marks.mark(blockOf(p + sides[side] + way * (most + (least - most) * k / across)));
            }
    }
    return marks.nodes();
}

} // namespace

int mostLevelSets(const Program& program) {
    Pile pile;
    int floor = 1;
    for (const Statement& statement : program.statements) {
        if (const auto* coat = std::get_if<Coat>(&statement.action))
            pile.lay(coat->material);
        else if (const auto* fill = std::get_if<Fill>(&statement.action))
            pile.lay(fill->material);
        else if (const auto* offset = std::get_if<Offset>(&statement.action))
            pile.lay(offset->material);
        else if (const auto* convert = std::get_if<Convert>(&statement.action))
            pile.convert(convert->from, convert->to);
        else if (const auto* erode = std::get_if<Erode>(&statement.action); erode && erode->andMetal)
            floor = 2;
    }
    return floor + static_cast<int>(pile.most());
}

Budget estimateBudget(const Program& program, const SurfaceMesh& surface, const VolumeScale& scale, int mapResolution,
                      std::size_t wholeTriangles) {
    Budget budget;
    const double levelSets = mostLevelSets(program);
    const double interiorBand = std::max(4.0, std::ceil(deepestPitVoxels(program, scale)) + 3.0);
    const double exteriorBand = bandOutsideVoxels(program, scale);
    // A sheet's back and front both carry a band.
    const double sides = surface.closed ? 1.0 : 2.0;
    const double area = sides * surface.area() / (scale.voxelSize * scale.voxelSize);
    budget.activeVoxels = area * (interiorBand + exteriorBand);
    const BandNodes nodes = bandNodes(surface, scale.voxelSize, interiorBand, exteriorBand);
    budget.allocatedVoxels = 512.0 * nodes.leaves;
    // Of OpenVDB's trees: a leaf's values and mask, and the tables of 16³ and 32³ children above them.
    constexpr double bytesPerLeaf = 2048.0 + 64.0 + 40.0, bytesPerLower = 4096.0 * 8.0 + 1024.0 + 24.0,
                     bytesPerUpper = 32768.0 * 8.0 + 8192.0 + 24.0;
    budget.volumeBytes =
        (nodes.leaves * bytesPerLeaf + nodes.lower * bytesPerLower + nodes.upper * bytesPerUpper) * (levelSets + 1.0);
    // Of maps a closest point of 12 bytes is held for every texel, and of all of them together some bands of rows. Per
    // texel of a row: displacement, diffuse, base colour, metallic, roughness and normal, height, fold and marks; a
    // lobe for every level set; thickness and coverage for every layer.
    const double size = mapResolution, layers = levelSets - 1.0;
    const double bytesPerTexel = 36.0 + 6.0 * levelSets + 6.0 * layers;
    constexpr double rowsHeld = 160.0;
    budget.mapBytes = size * (size * 12.0 + std::min(size, rowsHeld) * bytesPerTexel);
    // While it runs: a closest point per voxel, then what the operators need or the maps, triangles with their trees,
    // the program and its libraries. The last two as measured on spheres and the statuette.
    constexpr double programBytes = 150e6, bytesPerTriangle = 270.0, bytesPerPoint = 12.0;
    const double working = budget.activeVoxels * workingBytesPerVoxel(program, scale);
    const double model = static_cast<double>(surface.triangles.size() + wholeTriangles) * bytesPerTriangle;
    budget.residentBytes = programBytes + model + budget.volumeBytes + budget.activeVoxels * bytesPerPoint;
    budget.peakBytes = budget.residentBytes + std::max(working, budget.mapBytes);
    budget.diskBytes = budget.allocatedVoxels * 4.0 * (levelSets + 2.0) + size * size * bytesPerTexel;
    return budget;
}

} // namespace patina
