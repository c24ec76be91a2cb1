// A close-up at true scale: the displaced mesh is the voxel surface to a fiftieth of the layers' thickness.

#include "displaced_distance.h"

#include "operators/coat.h"
#include "optics/material_library.h"
#include "support/test_surfaces.h"
#include "surface/mesh_file.h"
#include "volume/region_model.h"
#include "volume/region_voxelize.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace patina {
namespace {

using Imath::V3d;

class RegionDisplacement : public testing::Test {
  protected:
    /// 200 µm of Spot's cage, which stands 10 cm high, in voxels of 2.08 µm (96 of them), under a coat in hills of 40 µm.
    /// \param um  at most, half of it at least
    void measure(double um) {
        Mesh mesh = readMesh(PATINA_SOURCE_DIR "/data/meshes/spot_control_mesh.obj");
        LimitSurfaceOptions limit;
        limit.level = 2;
        const Imath::V3f size = makeLimitSurface(mesh, limit).bounds().size();
        for (Imath::V3f& p : mesh.positions)
            p *= 0.1f / std::max({size.x, size.y, size.z});
        const SurfaceMesh coarse = makeLimitSurface(mesh, limit);
        const V3d middle(coarse.positions[coarse.triangles[coarse.triangles.size() / 3][0]]);
        const Imath::Box3d box(middle - V3d(100e-6), middle + V3d(100e-6));
        const double reach = um / 2.08 + 4.0;
        const RegionModel model(std::move(mesh), makeRegion(box, 200e-6 / 96, reach), {});
        const Region& region = model.region();
        voxel_ = region.localVoxelSize();

        initializeVolumes();
        Progress progress;
        const ClosedSurface closed = closeSurface(model.work(), sheetBackVoxels * voxel_);
        VoxelizeOptions options;
        options.scale.voxelSize = voxel_;
        options.scale.metresPerUnit = 1.0 / region.magnification;
        options.exteriorBand = reach;
        LayerVolume volume = voxelizeRegion(closed, region, options, progress);
        SurfaceBinding binding(volume, model.work(), closed);
        binding.refineBase(volume);
        const test::FunctionMap hills([&](const MapPoint& point) {
            const V3d p = point.position * (2.0 * M_PI / (40e-6 * region.magnification));
            return 0.75 + 0.25 * std::sin(p.x) * std::sin(p.y + 1.0) * std::sin(p.z + 2.0);
        });
        Workpiece work{volume, binding};
        coat(work, "cuprite_2", um, &hills, progress);

        const MaterialLibrary library = MaterialLibrary::load(PATINA_SOURCE_DIR "/data");
        const StackOptics optics({&library.at("copper"), &library.at("cuprite_2")});
        BakeOptions bakeOptions;
        bakeOptions.resolution = 512;
        bakeOptions.foldMask = true;
        const MapSet maps = bake(volume, model.shown(), optics, bakeOptions, progress);
        const Imath::Box3d inside(region.localBox().min + V3d(reach * voxel_), region.localBox().max - V3d(reach * voxel_));
        MapImage heights = *maps.find("displacement");
        found_ = test::measureDisplaced(volume, model.shown(), heights, *maps.find("fold_mask"), 4, VectorSpace::object,
                                        inside);
        std::fill(heights.floats.begin(), heights.floats.end(), 0.f);
        zero_ = test::measureDisplaced(volume, model.shown(), heights, *maps.find("fold_mask"), 4, VectorSpace::object,
                                       inside);
        folds_ = maps.summary.foldFraction;
        mean_ = 0.75 * um / 2.0833;
        for (const auto& [name, figures] : {std::pair("mesh to volume", found_.meshToVolume),
                                            std::pair("as it is      ", found_.meshAsItIs),
                                            std::pair("volume to mesh", found_.volumeToMesh),
                                            std::pair("at zero       ", zero_.meshToVolume)})
            std::printf("%s: %zu points, %zu masked: rms %.5f, 99.9 %% under %.5f, max %.5f of the mean thickness\n", name,
                        figures.points, figures.masked, figures.rms / mean_, figures.p999 / mean_, figures.max / mean_);
    }

    void expectAFiftieth() const {
        for (const auto& figures : {found_.meshToVolume, found_.meshAsItIs, found_.volumeToMesh}) {
            EXPECT_GT(figures.points, 3000u);
            EXPECT_LT(figures.rms, 0.02 * mean_);
        }
        for (const auto& figures : {zero_.meshToVolume, zero_.volumeToMesh})
            EXPECT_GT(figures.rms, 0.9 * mean_);
        EXPECT_LT(folds_, 1e-3);
    }

    test::DisplacedDistance found_, zero_;
    double voxel_ = 0.0, mean_ = 0.0, folds_ = 0.0; ///< local units; voxels
};

TEST_F(RegionDisplacement, ACoatOfSomeVoxelsIsHeldToAFiftieth) {
    measure(10.0);
    expectAFiftieth();
}

// An eighth of a voxel.
TEST_F(RegionDisplacement, AFilmBelowAVoxelIsHeldToAFiftieth) {
    measure(0.35);
    expectAFiftieth();
}

} // namespace
} // namespace patina
