#pragma once
// Any model becomes one that has an inside, or is known to be a sheet.

#include "surface/mesh.h"
#include "surface/mesh_report.h"

#include <string>

namespace patina {

enum class RepairMode {
    automatic, ///< holes of what has an inside are closed, all else that is open stays a sheet
    holes,     ///< every hole is closed
    sheet,     ///< no hole is closed: what is open stays a sheet
    none,      ///< the model is used as it is or not at all
};

/// Finds shells, holes, faces that lie against their neighbours, shells turned inside out, copies of faces and what
/// else a file can hold, and repairs what has one sensible answer:
///
/// - A face wound against its shell is turned round (the larger area is right). A closed shell that lies in no other
///   and whose faces look inward is turned over, with everything in it. A shell inside another keeps the way it lies to
///   it: the other way round it is a cavity, the same way round solid in solid, hidden.
/// - A shell with holes is a solid where its holes make up less than a tenth of its area (those that lie in the metal of
///   other shells not counted) and the winding number of the whole model says for nine tenths of its area that there is
///   an inside; its holes are closed by triangles of least area. Anything else open stays a sheet.
/// - Copies of faces are dropped. Vertices at one place are joined where that closes edges.
///
/// The closing triangles come behind the model's own faces; where the mesh has UVs they have none to themselves (all
/// corners at one of the rim's). Attributes stay.
/// \throws ModelError with mode `none`, where anything had to be changed: what and where
MeshReport repairMesh(Mesh& mesh, RepairMode mode);

/// Looks for faces that pierce each other and for walls thinner than two voxels; adds what it finds to the report.
void checkWalls(const SurfaceMesh& surface, double voxelSize, double longestSide, MeshReport& report);

/// "auto", "holes", "sheet", "none".
RepairMode repairModeNamed(const std::string& word);

} // namespace patina
