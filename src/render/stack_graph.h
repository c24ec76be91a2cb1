#pragma once
// A graph of the stack along one normal: heights above the bare metal in µm, layers in their colours.

#include "render/image.h"
#include "render/section_picture.h"
#include "volume/layer_volume.h"

#include <Imath/ImathVec.h>

#include <string>
#include <vector>

namespace patina {

struct StackGraphOptions {
    Imath::V3d at{0.0};            ///< on the metal, scene units
    int width = 640, height = 480; ///< pixels
    std::string title;
};

/// A piece of the normal in one material.
struct StackSpan {
    int region;          ///< 0 the metal, k layer k, -1 air: a pore, an overhang, what lies outside
    double fromUm, toUm; ///< above the metal as it was, real µm; below 0 where the metal itself was eroded
};

struct StackGraph {
    Image image; ///< encoded for display
    bool hasText = true;
    std::vector<StackSpan> spans; ///< from below upwards; the first begins and the last ends with the picture
};

/// The crossings are those of the interfaces themselves (bisected, not those of voxels), so that films far thinner than
/// a voxel are read and drawn; one thinner than a 4000th of the picture may be missed between two looks.
/// \param materials  the metal, then the layers bottom to top
/// \throws RunError where there is no metal at the place
StackGraph drawStackGraph(const LayerVolume& volume, const std::vector<SectionMaterial>& materials,
                          const StackGraphOptions& options);

} // namespace patina
