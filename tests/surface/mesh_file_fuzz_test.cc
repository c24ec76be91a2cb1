// Broken files by the thousand: a model or a ModelError, never anything else.

#include "base/errors.h"
#include "base/random.h"
#include "surface/limit_surface.h"
#include "surface/mesh_file.h"
#include "test_models.h"

#include <algorithm>
#include <iterator>

namespace patina {
namespace {

std::string bytesOf(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// A few bytes changed, doubled or dropped, or the end cut off.
std::string broken(std::string bytes, const KeyedRandom& random, int round) {
    const auto edits = 1 + random.words(0, round, 0, 0)[0] % 4;
    for (std::uint32_t edit = 0; edit < edits && !bytes.empty(); ++edit) {
        const auto words = random.words(1, round, static_cast<std::int32_t>(edit), 0);
        const std::size_t at = words[0] % bytes.size();
        const std::size_t length = std::min<std::size_t>(1 + words[2] % 12, bytes.size() - at);
        switch (words[1] % 7) {
        case 0:
            bytes[at] = static_cast<char>(words[3]);
            break;
        case 1:
            bytes[at] = "0123456789-/. \n\\enaif"[words[3] % 21];
            break;
        case 2:
            bytes.erase(at, length);
            break;
        case 3:
            bytes.insert(at, bytes.substr(at, length));
            break;
        case 4:
            bytes.resize(at);
            break;
        case 5:
            bytes[at] = static_cast<char>(bytes[at] ^ (1 << words[3] % 8));
            break;
        default:
            bytes.replace(at, length, length, '\xff');
        }
    }
    return bytes;
}

void fuzz(const std::string& name, const std::string& whole, int rounds) {
    const KeyedRandom random(2024, name, "fuzz");
    const TemporaryFile file(name, whole);
    int accepted = 0;
    for (int round = 0; round < rounds; ++round) {
        const std::string bytes = broken(whole, random, round);
        std::ofstream(file.path(), std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        try {
            const Mesh mesh = readMesh(file.path());
            ++accepted;
            for (const int vertex : mesh.faceVertices)
                ASSERT_LT(static_cast<std::size_t>(vertex), mesh.positions.size());
            for (const int uv : mesh.faceUvs)
                ASSERT_LT(static_cast<std::size_t>(uv), mesh.uvs.size());
            for (const SubdivisionScheme scheme : {SubdivisionScheme::automatic, SubdivisionScheme::none}) {
                const SurfaceMesh surface = makeLimitSurface(mesh, {scheme, 1, 0});
                ASSERT_FALSE(surface.triangles.empty());
            }
        } catch (const ModelError& error) {
            ASSERT_FALSE(error.message().empty());
        }
    }
    EXPECT_GT(accepted, 0);
    EXPECT_LT(accepted, rounds);
}

const char* const quads = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nvt 0 0\nvt 1 0\n"
                          "vt 1 1\nvt 0 1\nf 4/1 3/2 2/3 1/4\nf 5/1/1 6/2/1 7/3/1 8/4/1\nf 1//1 2//1 6//1 5//1\n"
                          "f -6 -5 -1 -2\nf 3 4 8 7\nf 1 5 8\nf 1 8 4\n";

TEST(MeshFileFuzz, brokenObjNeverCrashes) {
    fuzz("a.obj", quads, 800);
}

TEST(MeshFileFuzz, brokenOffNeverCrashes) {
    fuzz("a.off", "OFF\n5 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0.5 2 1\n4 0 1 2 3\n3 3 2 4\n3 0 1 4\n", 500);
}

TEST(MeshFileFuzz, brokenTextStlNeverCrashes) {
    fuzz("a.stl",
         "solid thing\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
         "facet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n",
         500);
}

TEST(MeshFileFuzz, brokenTextPlyNeverCrashes) {
    fuzz("a.ply",
         "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty short age\nelement face 3\n"
         "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n0 0 0 1 2 3 4\n"
         "1 0 0 1 2 3 4\n1 1 0 1 2 3 4\n0 1 0 1 2 3 4\n.5 2 1 1 2 3 4\n4 0 1 2 3 2 0 0\n3 3 2 4 0\n3 0 1 4 1 .5\n",
         800);
}

TEST(MeshFileFuzz, brokenBinaryPlyNeverCrashes) {
    Mesh cube = makeCube();
    cube.vertexAttributes["age"] = {0, 1, 2, 3, 4, 5, 6, 7};
    const TemporaryFile file("whole.ply", "");
    writePly(makeLimitSurface(cube, {SubdivisionScheme::none, -1, 0}), file.path());
    fuzz("a.ply", bytesOf(file.path()), 800);
}

TEST(MeshFileFuzz, brokenBinaryStlNeverCrashes) {
    std::string bytes(80, ' ');
    bytes += std::string("\2\0\0\0", 4);
    const float corners[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    for (int i = 0; i < 2; ++i) {
        bytes.append(12, '\0');
        bytes.append(reinterpret_cast<const char*>(corners + 9 * i), 36);
        bytes.append(2, '\0');
    }
    fuzz("a.stl", bytes, 500);
}

} // namespace
} // namespace patina
