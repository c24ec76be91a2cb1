#pragma once
// The shells of a mesh, with what would close their holes.

#include "surface/mesh.h"
#include "surface/mesh_topology.h"
#include "surface/winding_number.h"

#include <Imath/ImathVec.h>

#include <vector>

namespace patina {

/// A loop of open edges.
struct ShellHole {
    std::vector<int> corners;          ///< of the mesh, round the closing triangles
    std::vector<Imath::V3i> triangles; ///< of corner numbers
    double area = 0.0;                 ///< of the closing triangles, scene units squared
    double length = 0.0;               ///< of its rim, scene units
    Imath::V3d centre{0.0};

    /// Without an area: a T-junction, or a seam of faces that do not share vertices.
    bool isCrack() const { return area <= 1e-7 * length * length; }
};

/// Faces joined over their edges (MeshTopology).
struct MeshShell {
    std::vector<int> faces;
    std::vector<ShellHole> holes;
    bool closable = true; ///< its open sides are loops
    bool closed = true;   ///< has no open sides, or they are closed
    double area = 0.0;    ///< scene units squared
    double volume = 0.0;  ///< signed, as the file winds it, holes closed; scene units cubed
    Imath::V3d low, high; ///< its box
    bool outward = true;  ///< how it shall lie
    int parent = -1;      ///< the smallest shell around it
    bool drop = false;
    std::vector<Imath::V3i> triangles; ///< of vertices, facing outward; of holes only once they are closed

    /// Encloses nothing.
    bool isFlat() const;
    void closeHoles(const Mesh& mesh);
};

/// \param starts  first corner of each face (faceStarts())
/// \param topology  of that mesh
std::vector<MeshShell> gatherShells(const Mesh& mesh, const std::vector<int>& starts, const MeshTopology& topology);

/// Whether shells with holes enclose something, by the winding number of the whole model as it is closed by now. Sees
/// the mesh and the shells it is made from for as long as it is used.
class ShellInside {
  public:
    ShellInside(const Mesh& mesh, const std::vector<MeshShell>& shells);

    /// The part of a shell's area behind which the winding number is near a whole number, 0 to 1.
    double definedFraction(const MeshShell& shell) const;
    /// The area of a shell's holes that lie in the air, over its own.
    double openFraction(const MeshShell& shell) const;

  private:
    const Mesh& mesh_;
    WindingNumber everything_;
};

} // namespace patina
