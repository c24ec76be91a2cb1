#pragma once
// What was found out about a model, and what was done about it.

#include <Imath/ImathVec.h>

#include <cstddef>
#include <string>
#include <vector>

namespace patina {

/// Faces and vertices are numbered from 0 here; texts number them from 1, as OBJ files do.
struct MeshReport {
    enum class ShellKind {
        solid,  ///< metal inside, air outside
        cavity, ///< air inside a solid
        hidden, ///< solid inside solid: no air comes to it
        sheet,  ///< open: gets a back
    };
    struct Shell {
        ShellKind kind = ShellKind::solid;
        std::size_t faces = 0;
        double area = 0.0;       ///< scene units squared
        double volume = 0.0;     ///< enclosed, scene units cubed; 0 of sheets
        bool turnedOver = false; ///< its faces looked inward and were turned round
        std::size_t turnedFaces = 0; ///< single faces that lay against the others and were turned round
        std::size_t openEdges = 0;   ///< before the repair
        int firstFace = 0;
        Imath::V3f place; ///< a corner of its first face
    };
    struct Hole {
        int shell = 0;
        std::size_t edges = 0;
        double area = 0.0; ///< of what closes it, scene units squared
        Imath::V3f centre;
        int vertex = 0; ///< one of its rim
        bool closed = false;
        bool crack = false; ///< without an area: a T-junction, a seam of faces that do not share vertices
    };
    /// A kind of fault: how often, and where first.
    struct Fault {
        std::size_t count = 0;
        std::string where; ///< "face 12, at (x, y, z)"
    };
    std::vector<Shell> shells;
    std::vector<Hole> holes;
    Fault turnedFaces, copiedFaces, flatFaces, crowdedEdges, pinchedVertices, oneSidedEdges, piercedFaces;

    struct ThinWalls {
        double fraction = 0.0; ///< of the surface that lies on walls thinner than two voxels
        double thinnest = 0.0; ///< scene units, the thinnest there is
        double thin = 0.0;     ///< scene units; a thousandth of the surface is thinner
        std::string where;     ///< the thinnest
    } thinWalls;

    bool repaired = false;             ///< the mesh is not as it was read
    std::vector<std::string> warnings; ///< one line each
    std::vector<std::string> notices;  ///< one line each; less important
};

const char* nameOf(MeshReport::ShellKind kind);

} // namespace patina
