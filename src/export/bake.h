#pragma once
// Maps from a volume: for every texel the stack along the base's normal, and its light.

#include "base/progress.h"
#include "export/exr_file.h"
#include "optics/layer_stack.h"
#include "surface/mesh.h"
#include "volume/layer_volume.h"

#include <Imath/ImathVec.h>

namespace patina {

struct BakeOptions {
    int resolution = 1024;           ///< texels along a side, per UV tile
    int gutter = 16;                 ///< texels around each chart
    bool keepExaggeration = false;   ///< displacement as drawn in the volume instead of real
    bool materialId = false;         ///< also bake material_id
    bool foldMask = false;           ///< also bake fold_mask: 1 where the interface folds over
    bool vectorDisplacement = false; ///< also bake vector_displacement: object space, scene units
    bool fields = false;             ///< also bake field_NAME of every field that the volume holds
};

/// Averages over the texels in charts, for reports.
struct BakeSummary {
    double coveredFraction = 0.0;    ///< of the texels, in charts
    double unreadableFraction = 0.0; ///< of those, where no base crossed the normal (left at zero)
    float maxDisplacement = 0.f;     ///< max |h|, scene units as exported
    double foldFraction = 0.0;       ///< of those: the outermost interface folds over (OuterSurface::foldsOver)
    Imath::V3d meanColour{0.0};      ///< linear Rec.709 of the flattened base colour, over all charts
    double greenFraction = 0.0;      ///< texels whose base colour has a* < -4 in CIELAB
};

struct MapSet {
    std::vector<MapImage> maps; ///< displacement, diffuse, lobe_00_…, base_color, metallic, roughness, normal,
                                ///< thickness_01_…, coverage_01_…, and what the options add
    BakeSummary summary;

    const MapImage* find(const std::string& name) const;
};

/// \param optics  of [metal, layer 1, … layer n] of the volume, in this order
/// \throws ModelError as makeTexelMap() does
MapSet bake(const LayerVolume& volume, const SurfaceMesh& surface, const StackOptics& optics,
            const BakeOptions& options, Progress& progress);

} // namespace patina
