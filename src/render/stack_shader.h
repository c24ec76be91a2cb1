#pragma once
// The look of a point of the model, read from the volume itself: what pictures are shaded with.

#include "optics/bsdf_batch.h"
#include "optics/layer_stack.h"
#include "optics/patina_bsdf.h"
#include "render/features.h"
#include "render/look_table.h"
#include "surface/mesh.h"
#include "surface/ray_batch.h"
#include "volume/stack_probe.h"

#include <cstddef>
#include <vector>

namespace patina {

/// Where a StackShader reads the stack.
enum class StackReading {
    /// At the vertices, mixed over triangles whose edges are no longer than a voxel and a half, which cannot miss
    /// anything; at the point itself on larger ones.
    adaptive,
    vertices, ///< at the vertices alone
    points,   ///< at every point that is asked for: slow, and what the others are measured by
};

/// The stack along the base's normal at a surface point, as thicknesses, height and BSDF. Reads the stack of every
/// vertex once, in parallel. Safe from any thread; valid while volume, surface and optics are.
class StackShader {
  public:
    /// \param surface  on the base: positions and unit normals to read along
    /// \param optics  of [metal, layer 1, … layer n] of the volume
    StackShader(const LayerVolume& volume, const SurfaceMesh& surface, const StackOptics& optics,
                StackReading reading = StackReading::adaptive);

    PatinaBsdf bsdf(const SurfacePoint& point) const;
    /// Of many points at once (scene.h, MaterialsAt), to the bit the same.
    void bsdfs(const HitBatch& hits, const std::vector<int>& from, std::size_t count, BsdfBatch& into) const;
    PointFeatures features(const SurfacePoint& point) const;

    /// Height of the air's interface above the base at every vertex, scene units as drawn in the volume.
    const std::vector<float>& vertexHeights() const { return heights_; }

  private:
    void readVertices();
    bool mixes(int triangle) const { return mixed_[std::size_t(triangle)] != 0; }
    /// Each layer's thickness, µm.
    void thicknessAt(const SurfacePoint& point, float* thicknessUm) const;

    const SurfaceMesh& surface_;
    const StackOptics& optics_;
    StackProbe probe_;
    StackReading reading_;
    std::vector<float> heights_;
    std::vector<float> thicknessesUm_; ///< of each vertex, layer by layer
    LookTable looks_;
    bool allMixed_ = false;
    std::vector<char> mixed_; ///< of each triangle: whether its corners tell what lies between them
};

} // namespace patina
