#pragma once
// Maps from a volume: for every texel the stack along the base's normal, and its light.

#include "base/progress.h"
#include "export/exr_file.h"
#include "export/vector_space.h"
#include "optics/layer_stack.h"
#include "surface/mesh.h"
#include "volume/layer_volume.h"

#include <Imath/ImathVec.h>

#include <utility>

namespace patina {

struct BakeOptions {
    int resolution = 1024;           ///< texels along a side, per UV tile
    int gutter = 16;                 ///< texels around each chart, at most 32
    bool keepExaggeration = false;   ///< displacement as drawn in the volume instead of real
    double displacementUnits = 1.0;  ///< units of the maps' displacement per scene unit of the volume
    bool materialId = false;         ///< also bake material_id
    bool foldMask = false;           ///< also bake fold_mask: 1 where a height map cannot follow (docs/export.md)
    bool vectorDisplacement = false; ///< also bake vector_displacement: scene units
    bool fields = false;             ///< also bake field_NAME of every field that the volume holds

    /// What the channels of vector_displacement are.
    VectorSpace vectorSpace = VectorSpace::object;
};

/// Averages over the texels in charts of all tiles, for reports.
struct BakeSummary {
    std::vector<Imath::V2i> tiles;   ///< the UV tiles that were baked
    std::size_t texels = 0;          ///< in charts
    double coveredFraction = 0.0;    ///< of the texels, in charts
    double unreadableFraction = 0.0; ///< of those, where no base crossed the normal (left at zero)
    double supersampledFraction = 0.0; ///< of those, read at more than one point
    float maxDisplacement = 0.f;     ///< max |h|, as exported
    double foldFraction = 0.0;       ///< of those, under the fold mask: the outermost interface folds over
                                     ///< (OuterSurface::foldsOver), the normal does not come to it (misses), normals
                                     ///< cross before they do, or the height jumps between neighbours
    double voxelisationRms = 0.0, voxelisationMax = 0.0; ///< of the voxels' base from the surface along the normal,
                                                         ///< voxels: no displacement holds it
    double overlapFraction = 0.0;    ///< of those, in charts of two faces; few (overlapTolerance)
    std::pair<int, int> overlappingFaces{-1, -1}; ///< two of them, from 0
    Imath::V3d meanColour{0.0};      ///< linear Rec.709 of the flattened base colour, over all charts
    double greenFraction = 0.0;      ///< texels whose base colour has a* < -4 in CIELAB
};

/// Receives maps row by row, tile by tile. Within a tile all maps advance together, in bands of rows; calls for
/// different maps come from different threads.
class MapSink {
  public:
    virtual ~MapSink() = default;
    /// The maps of a tile, in the order of their files; attributes that are known only at the end are 0.
    virtual void begin(const std::vector<MapInfo>& maps) = 0;
    /// \param rows  `count` rows of map `map`, interleaved, floats or halves
    virtual void write(int map, const void* rows, int count) = 0;
    /// The tile is complete.
    virtual void end() = 0;
    /// All tiles are. \param numbers  attributes that have become known, by map of a tile
    virtual void finish(const std::vector<std::vector<std::pair<std::string, float>>>& numbers) = 0;
};

struct MapSet {
    std::vector<MapImage> maps; ///< displacement, diffuse, lobe_00_…, base_color, metallic, roughness, normal,
                                ///< thickness_01_…, coverage_01_…, and what the options add; so for each tile
    BakeSummary summary;

    const MapImage* find(const std::string& name) const; ///< of the first tile
};

/// Bakes into a sink; holds a band of rows of every map, and 12 bytes a texel. Texels are anti-aliased: where one is
/// wider than a voxel it is the mean of 4, 9 or 16 points spread evenly over it, elsewhere of four where its neighbours
/// show another layer. IDs are those of most points.
/// \param optics  of [metal, layer 1, … layer n] of the volume, in this order
/// \throws ModelError as makeTexelMap() does
BakeSummary bakeInto(MapSink& sink, const LayerVolume& volume, const SurfaceMesh& surface, const StackOptics& optics,
                     const BakeOptions& options, Progress& progress);

/// The same into memory.
MapSet bake(const LayerVolume& volume, const SurfaceMesh& surface, const StackOptics& optics,
            const BakeOptions& options, Progress& progress);

} // namespace patina
