#pragma once
// Small models and files for the tests of this room.

#include "surface/mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

namespace patina {

/// From the nearest of a surface's vertices.
inline float distanceTo(const SurfaceMesh& surface, const Imath::V3f& point) {
    float nearest = 1e30f;
    for (const Imath::V3f& position : surface.positions)
        nearest = std::min(nearest, (position - point).length());
    return nearest;
}

inline Mesh makeCube() {
    Mesh mesh;
    mesh.name = "cube";
    for (int i = 0; i < 8; ++i)
        mesh.positions.emplace_back(i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f);
    mesh.faceSizes.assign(6, 4);
    mesh.faceVertices = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    return mesh;
}

/// columns × rows quads of side 1 in z = 0, facing +z, with UVs equal to the position over the size.
inline Mesh makeSheet(int columns, int rows) {
    Mesh mesh;
    mesh.name = "sheet";
    for (int y = 0; y <= rows; ++y)
        for (int x = 0; x <= columns; ++x) {
            mesh.positions.emplace_back(static_cast<float>(x), static_cast<float>(y), 0.f);
            mesh.uvs.emplace_back(static_cast<float>(x) / static_cast<float>(columns),
                                  static_cast<float>(y) / static_cast<float>(rows));
        }
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const int corner = y * (columns + 1) + x;
            mesh.faceSizes.push_back(4);
            for (const int vertex : {corner, corner + 1, corner + columns + 2, corner + columns + 1}) {
                mesh.faceVertices.push_back(vertex);
                mesh.faceUvs.push_back(vertex);
            }
        }
    return mesh;
}

/// A file that goes when the test ends.
class TemporaryFile {
  public:
    TemporaryFile(const std::string& name, const std::string& bytes) {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::path(testing::TempDir()) / (std::string("patina_surface_") + test->name());
        std::filesystem::create_directories(folder_);
        path_ = folder_ / name;
        std::ofstream(path_, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    }
    ~TemporaryFile() {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path folder_, path_;
};

inline std::filesystem::path sharedModel(const std::string& name) {
    return std::filesystem::path(PATINA_SOURCE_DIR) / ".." / "shared" / "data" / "meshes" / name;
}

} // namespace patina

#define PATINA_NEEDS_MODEL(name)                                                                                       \
    if (!std::filesystem::exists(sharedModel(name)))                                                                   \
    GTEST_SKIP() << "the model " << name << " is not here"
