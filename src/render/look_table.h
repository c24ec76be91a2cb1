#pragma once
// The looks of a mesh's vertices, packed for mixing: shading costs three reads and no optics.

#include "optics/bsdf_batch.h"
#include "optics/patina_bsdf.h"
#include "surface/ray_batch.h"

#include <Imath/ImathVec.h>

#include <cstddef>
#include <vector>

namespace patina {

/// One Appearance per vertex. Reflected light is linear in what is mixed, so a mix is what a point sees that is covered
/// by the corners' looks in proportion: it conserves energy where they do. Lobes' widths belong to the materials and
/// are the same everywhere. 12 bytes a vertex and 32 for each lobe that is seen anywhere.
class LookTable {
  public:
    LookTable(const StackOptics& optics, std::size_t vertices);

    /// \param look  of these optics. Different vertices from different threads.
    void set(std::size_t vertex, const Appearance& look);
    /// Leaves out the lobes that are black everywhere. Once, after all set() and before any bsdf().
    void pack();

    /// Mixed over a triangle, by the weights of its second and third corner. Safe from any thread.
    PatinaBsdf bsdf(const Imath::V3i& corners, float u, float v) const;

    /// The same of many hits: lanes 0 … count - 1 of a batch that has begun (scene.h, MaterialsAt).
    void bsdfs(const std::vector<Imath::V3i>& triangles, const HitBatch& hits, const std::vector<int>& from,
               std::size_t count, BsdfBatch& into) const;

  private:
    // Colour, edge colour, air, edge of the air.
    static constexpr int valuesPerLobe = 8;

    OpticsModel model_;
    int lobes_;
    std::vector<LobeShape> shapes_; ///< of each lobe
    std::size_t stride_;
    std::vector<float> values_; ///< of each vertex: diffuse, then lobes
};

} // namespace patina
