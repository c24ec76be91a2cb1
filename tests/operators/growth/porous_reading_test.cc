// A porous layer's interface encloses as much as its particles fill, whatever their size and how they lie to the
// voxels.

#include "operators/growth/grow.h"
#include "operators/growth/voxel_growth.h"
#include "operators/growth/voxel_interface.h"
#include "operators/growth/voxel_levels.h"
#include "support/test_surfaces.h"
#include "volume/vdb_file.h"

#include <Imath/ImathVec.h>
#include <gtest/gtest.h>
#include <openvdb/tools/Interpolation.h>

#include <cmath>
#include <cstdint>
#include <string>

namespace patina {
namespace {

/// A ballistic layer of cells `cell` wide and `level` high (voxels) on a plane through the middle of a box, upright or
/// turned about two axes.
class PorousBox {
  public:
    static constexpr int side = 44, height = 56;

    PorousBox(double cell, double level, bool turned) : cell_(cell), level_(level) {
        const double a = turned ? 0.62 : 0.0, b = turned ? 0.31 : 0.0;
        const Imath::V3d u(std::cos(a), 0.0, -std::sin(a)), v(0.0, 1.0, 0.0);
        normal_ = Imath::V3d(std::sin(a), 0.0, std::cos(a));
        u_ = u * std::cos(b) + v * std::sin(b);
        v_ = v * std::cos(b) - u * std::sin(b);
        // Upright, voxel centres would lie on the borders of cells.
        middle_ = Imath::V3d(side / 2.0, side / 2.0, 0.0) - (turned ? Imath::V3d(0.0) : Imath::V3d(0.25, 0.25, 0.0));
        GrowthOptions options;
        options.model = GrowthModel::ballisticDeposition;
        options.step = options.total = 26;
        grown_ = growParticles(flatLattice(cells, cells, true), options, 5, "porous");
        makeInterface();
    }

    double heightAt(const Imath::V3d& p) const { return (p - middle_).dot(normal_); }
    bool isFilled(const Imath::V3d& p) const {
        const double h = heightAt(p);
        const Imath::V3d r = p - middle_;
        const auto index = [&](double x) { return std::size_t(int(std::floor(x / cell_)) % cells + cells) % cells; };
        return h <= 0.0 || grown_.occupancy.holds(index(r.dot(v_)) * cells + index(r.dot(u_)), levelOf(h));
    }
    bool isInside(const Imath::V3d& p) const {
        return openvdb::tools::BoxSampler::sample(interface_->getConstAccessor(), openvdb::Vec3R(p.x, p.y, p.z)) < 0.f;
    }

  private:
    static constexpr int cells = 128;

    std::int64_t levelOf(double h) const { return static_cast<std::int64_t>(std::ceil((h - 1e-3) / level_)); }
    void makeInterface() {
        const auto surface = openvdb::FloatGrid::create(float(height));
        auto access = surface->getAccessor();
        for (int x = 0; x < side; ++x)
            for (int y = 0; y < side; ++y)
                for (int z = -25; z < height; ++z)
                    if (const double h = heightAt(Imath::V3d(x, y, z)); h > -5.0)
                        access.setValue({x, y, z}, float(h));
        interface_ = surface->deepCopy();
        for (auto voxel = interface_->beginValueOn(); voxel; ++voxel) {
            const openvdb::Coord c = voxel.getCoord();
            const Imath::V3d p(c.x(), c.y(), c.z());
            const double h = heightAt(p);
            if (h <= 0.0)
                continue;
            const double top = double(levelOf(h)) * level_;
            voxel.setValue(float(isFilled(p) ? std::min(0.0, h - top) : std::max(1e-3, h - top + level_)));
        }
        interfaceOfVoxels(*surface, *interface_, 1.0, true, Progress());
    }

    double cell_, level_;
    Imath::V3d normal_, u_, v_, middle_;
    GrownParticles grown_;
    openvdb::FloatGrid::Ptr interface_;
};

TEST(PorousReading, theInterfaceEnclosesWhatParticlesFill) {
    initializeVolumes();
    for (const bool turned : {false, true})
        for (const int cell : {1, 2, 3}) {
            const PorousBox box(cell, cell == 1 ? 1.0 : 0.85 * cell, turned);
            // Near the metal, and within the layer.
            double inside[2] = {}, filled[2] = {}, all[2] = {};
            for (double x = 8.1; x < PorousBox::side - 8; x += 0.47)
                for (double y = 8.2; y < PorousBox::side - 8; y += 0.47)
                    for (double z = -20.13; z < PorousBox::height - 3; z += 0.47) {
                        const Imath::V3d p(x, y, z);
                        const double h = box.heightAt(p);
                        if (h < 0.0 || h > 40.0)
                            continue;
                        const int part = h > 4.0;
                        inside[part] += box.isInside(p);
                        filled[part] += box.isFilled(p);
                        all[part] += 1.0;
                    }
            const double foot = 4.0 * (inside[0] - filled[0]) / all[0], bulk = inside[1] / filled[1];
            const std::string name = std::string(turned ? "turned" : "upright") + std::to_string(cell);
            RecordProperty(name, std::to_string(foot) + " voxel, " + std::to_string(bulk));
            EXPECT_NEAR(foot, 0.0, 0.1) << name; // voxels
            EXPECT_NEAR(bulk, 1.0, 0.02) << name;
            EXPECT_GT(filled[1] / all[1], 0.25) << name; // a layer is there
        }
}

TEST(VoxelLevels, columnsKeepTheirSolidAndOneHistory) {
    for (const double level : {0.13, 0.42, 0.97})
        for (const double phase : {0.0, 0.3, 0.99}) {
            constexpr std::int32_t top = 90, foot = 40;
            const auto column = [] {
                LevelOccupancy occupancy(1);
                for (std::int32_t l = 1; l <= top; ++l)
                    if (l % 7 < 3 || l % 5 == 1)
                        occupancy.add(0, l);
                return occupancy;
            };
            const auto count = [](const LevelOccupancy& occupancy, std::int32_t last) {
                int filled = 0;
                for (std::int32_t l = 1; l <= last; ++l)
                    filled += occupancy.holds(0, l);
                return filled;
            };
            LevelOccupancy whole = column(), before = column(), since = column();
            const double solid = level * count(whole, top);
            const std::int32_t high = makeVoxelLevels(whole, 0, 0, top, level, phase);
            EXPECT_EQ(count(whole, 128), int(std::floor(phase + solid)));
            EXPECT_LE(high, std::ceil(top * level));
            // What stood there and what has come since are together what the whole is.
            makeVoxelLevels(before, 0, 0, foot, level, phase);
            makeVoxelLevels(since, 0, foot, top - foot, level, phase);
            EXPECT_EQ(count(before, 128) + count(since, 128), count(whole, 128));
        }
}

TEST(VoxelLevels, scriptsDecideWhatIsMadeOfParticlesNotVoxels) {
    GrowthOptions options;
    options.model = GrowthModel::ballisticDeposition;
    options.step = options.total = 4;
    for (const double um : {3.0, 4.6, 20.0})
        for (const double voxel : {1.0, 0.5, 0.25, 0.1}) {
            VolumeScale scale = test::voxelScale();
            scale.voxelSize = voxel;
            EXPECT_EQ(growsInVoxels(scale, um, options, 1.0 / voxel), um > 4.0) << um << " " << voxel;
        }
}

} // namespace
} // namespace patina
