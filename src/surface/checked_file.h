#pragma once
// What stands between a file and OpenMesh's readers, which trust their input: they take any index, loop over any
// count, and lose their place at a "nan". Each function here walks a whole file, refuses what is broken, and gives the
// same mesh in the plainest form of its format.

#include "surface/mesh.h"

#include <string>
#include <string_view>
#include <vector>

namespace patina {

struct CheckedFile {
    std::string bytes;
    bool binary = false;
    int vertexCount = 0; ///< for PLY, whose custom properties need their room beforehand
    int faceCount = 0;
    std::vector<Crease> creases; ///< what the reader knows nothing of; vertices as the file counts them, from 0
    std::vector<SharpCorner> corners;
};

/// Vertices, UVs, faces, creases and sharp corners; indices counted from the start; a face's repeated vertices removed;
/// no material files.
CheckedFile checkedObj(std::string_view bytes, const std::string& place);
/// The header rewritten with type names that the reader knows, then the vertices, then the faces.
CheckedFile checkedPly(std::string_view bytes, const std::string& place);
/// As it is, once it is clear whether it is text.
CheckedFile checkedStl(std::string_view bytes, const std::string& place);
/// Positions and faces, without comments (colours and normals of the variants of OFF are left out).
CheckedFile checkedOff(std::string_view bytes, const std::string& place);

/// Coordinates beyond this cannot be squared and summed safely, and no model is that large.
constexpr double largestCoordinate = 1e15;
/// More corners than this are a broken count rather than a face (and OpenMesh compares all pairs of them).
constexpr long long mostCorners = 16384;

} // namespace patina
