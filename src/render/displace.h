#pragma once
// The surface moved out to where the air begins.

#include "surface/mesh.h"

#include <memory>
#include <vector>

namespace patina {

/// Moves every vertex along its normal by its height (scene units, one per vertex) and tilts the normals accordingly:
/// the change of the angle-weighted geometric normal is added to the limit normal, so that height 0 keeps its normals
/// to the bit. Vertices at the same place with normals less than 60 degrees apart (UV seams) move together, by the
/// mean: no seam cracks open; the two sides of a thin sheet stay apart.
/// \throws RunError where the number of heights is not that of the vertices or one is not finite.
SurfaceMesh displaced(const SurfaceMesh& surface, const std::vector<float>& heights);

/// The same for one surface and many heights: its seams and its own geometric normals are looked for once.
class Displacer {
  public:
    /// \param surface  must outlive this
    explicit Displacer(const SurfaceMesh& surface);
    ~Displacer();
    Displacer(Displacer&&) noexcept;

    SurfaceMesh displaced(const std::vector<float>& heights) const;

  private:
    struct Seams;
    std::unique_ptr<const Seams> seams_;
};

} // namespace patina
