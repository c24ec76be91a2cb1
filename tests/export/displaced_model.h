#pragma once
// A model under thick layers, baked, displaced and held against its volume.

#include "displaced_distance.h"
#include "seam_jumps.h"

#include "operators/coat.h"
#include "optics/material_library.h"
#include "support/test_surfaces.h"
#include "surface/atlas.h"
#include "surface/limit_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

namespace patina::test {

// A model under a coat of 4 to 8 voxels in soft hills, its maps, and how far the displaced mesh is from the volume.
struct Measured {
    DisplacedDistance displaced, undisplaced;
    DisplacedDistance otherSpace; ///< vectors of a space of the surface's taken for the object's
    double foldFraction = 0.0;
    std::vector<double> seams;       ///< jumps of the height across UV seams, voxels, sorted
    std::vector<double> foldedSeams; ///< the same under the fold mask

    /// Of the points under the fold mask, those where the jump is larger than is asked elsewhere.
    double openFoldedShare() const {
        const auto first = std::upper_bound(foldedSeams.begin(), foldedSeams.end(), 0.02);
        return double(foldedSeams.end() - first) / double(std::max<std::size_t>(1, foldedSeams.size()));
    }
};

inline Measured measure(Mesh mesh, int voxels, int resolution, int dice, bool atlas, bool vectors = false,
                        VectorSpace space = VectorSpace::object) {
    if (atlas)
        makeFaceAtlas(mesh, resolution);
    for (Imath::V2f& uv : mesh.uvs) // as the program does: UVs that stick out by a texel
        uv = {std::clamp(uv.x, 0.f, 1.f), std::clamp(uv.y, 0.f, 1.f)};
    LimitSurfaceOptions limit;
    limit.level = 1;
    const Imath::V3f size = makeLimitSurface(mesh, limit).bounds().size();
    const double side = std::max({size.x, size.y, size.z});
    VolumeScale scale;
    scale.voxelSize = side / voxels;
    scale.metresPerUnit = 1e-6 / scale.voxelSize; // a micrometre is a voxel
    limit.level = -1;
    limit.targetEdge = 1.5 * scale.voxelSize;
    const auto piece = makePiece(makeLimitSurface(mesh, limit), scale, 12.0);
    auto work = piece->work();
    // Hills of 1/8 of the model, but 16 voxels and more: less, and the coat is thicker than they are wide.
    const double hill = std::max(side / 8.0, 16.0 * scale.voxelSize);
    const FunctionMap hills([&](const MapPoint& point) {
        const Imath::V3d p = point.position * (2.0 * M_PI / hill);
        return 0.75 + 0.25 * std::sin(p.x) * std::sin(p.y + 1.0) * std::sin(p.z + 2.0);
    });
    coat(work, "cuprite_2", 8.0, &hills, piece->progress);

    const MaterialLibrary library = MaterialLibrary::load(PATINA_SOURCE_DIR "/data");
    const StackOptics optics({&library.at("copper"), &library.at("cuprite_2")});
    BakeOptions options;
    options.resolution = resolution;
    options.foldMask = true;
    options.vectorDisplacement = vectors;
    options.vectorSpace = space;
    MapSet maps = bake(*piece->volume, piece->surface, optics, options, piece->progress);
    MapImage zero = *maps.find(vectors ? "vector_displacement" : "displacement");
    Measured measured;
    measured.foldFraction = maps.summary.foldFraction;
    measured.displaced = measureDisplaced(*piece->volume, piece->surface, zero, *maps.find("fold_mask"), dice, space);
    if (space != VectorSpace::object)
        measured.otherSpace = measureDisplaced(*piece->volume, piece->surface, zero, *maps.find("fold_mask"), 1);
    std::fill(zero.floats.begin(), zero.floats.end(), 0.f);
    measured.undisplaced = measureDisplaced(*piece->volume, piece->surface, zero, *maps.find("fold_mask"), 1);
    if (!vectors) {
        SeamJumps jumps = seamJumps(piece->surface, *maps.find("displacement"), *maps.find("fold_mask"), 13);
        measured.seams = std::move(jumps.open);
        measured.foldedSeams = std::move(jumps.folded);
        for (auto* seams : {&measured.seams, &measured.foldedSeams})
            for (double& jump : *seams)
                jump /= scale.voxelSize;
        const auto under = [](const std::vector<double>& seams, double share) {
            return seams.empty() ? 0.0 : seams[static_cast<std::size_t>(share * double(seams.size() - 1))];
        };
        for (const auto& [name, seams] : {std::pair{"seams", &measured.seams}, {"  under the fold mask", &measured.foldedSeams}})
            std::printf("%s: %zu points, jumps: 90 %% under %.4f, 99 %% under %.4f, 99.9 %% under %.4f, max %.4f voxel\n",
                        name, seams->size(), under(*seams, 0.9), under(*seams, 0.99), under(*seams, 0.999),
                        under(*seams, 1.0));
        std::printf("  of those %.2f %% above 0.02\n", 100.0 * measured.openFoldedShare());
    }
    const auto print = [](const char* name, const DistanceFigures& figures) {
        std::printf("%s: %zu points, %zu masked: rms %.4f, 99.9 %% under %.4f, max %.4f voxel\n", name, figures.points,
                    figures.masked, figures.rms, figures.p999, figures.max);
    };
    print("displaced mesh to volume", measured.displaced.meshToVolume);
    print("  of fine texels        ", measured.displaced.fineTexels);
    print("  with voxelisation     ", measured.displaced.meshAsItIs);
    print("volume to displaced mesh", measured.displaced.volumeToMesh);
    print("without displacement    ", measured.undisplaced.meshToVolume);
    std::printf("folds: %.4f %%; voxelisation: rms %.4f, max %.4f voxel\n", measured.foldFraction * 100.0,
                maps.summary.voxelisationRms, maps.summary.voxelisationMax);
    return measured;
}

// What is asked of it where the layers are 4 voxels and more.
inline void expectTheVoxelSurface(const Measured& measured, std::size_t fewestPoints, double most = 0.5) {
    for (const auto& figures : {measured.displaced.meshToVolume, measured.displaced.volumeToMesh}) {
        EXPECT_GT(figures.points, fewestPoints);
        EXPECT_LT(figures.rms, 0.05);
        EXPECT_LT(figures.p999, 0.25);
        EXPECT_LT(figures.max, most);
    }
}

// Zero displacement must be caught: the mesh is then a coat away from the interface.
inline void expectControl(const Measured& measured) {
    EXPECT_GT(measured.undisplaced.meshToVolume.rms, 3.5);
    EXPECT_GT(measured.undisplaced.volumeToMesh.rms, 3.5);
}

} // namespace patina::test
