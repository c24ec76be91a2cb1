#include "surface/mesh_file.h"

#include "base/errors.h"
#include "base/names.h"
#include "surface/checked_file.h"
#include "surface/face_list_importer.h"
#include "surface/triangulate.h"

#include <OpenMesh/Core/IO/reader/OBJReader.hh>
#include <OpenMesh/Core/IO/reader/OFFReader.hh>
#include <OpenMesh/Core/IO/reader/PLYReader.hh>
#include <OpenMesh/Core/IO/reader/STLReader.hh>
#include <OpenMesh/Core/System/omstream.hh>

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <mutex>
#include <sstream>
#include <system_error>

namespace patina {

using Imath::V3f;

namespace {

enum class Format { obj, ply, stl, off };

Format formatOf(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    if (!extension.empty())
        extension.erase(0, 1);
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c); });
    if (extension == "obj")
        return Format::obj;
    if (extension == "ply")
        return Format::ply;
    if (extension == "stl")
        return Format::stl;
    if (extension == "off")
        return Format::off;
    const std::string near = didYouMean(extension, {"obj", "ply", "stl", "off"});
    throw ModelError(path.string(),
                     extension.empty() ? std::string("the file's name has no extension that says its format")
                                       : fmt::format("models of format '{}' cannot be read", extension),
                     near.empty() ? "export the model as OBJ, PLY, STL or OFF" : near);
}

std::string readBytes(const std::filesystem::path& path) {
    const std::string place = path.string();
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status))
        throw ModelError(place, "there is no such file", "check the model's name and folder");
    if (std::filesystem::is_directory(status))
        throw ModelError(place, "this is a folder, not a model", "name the OBJ, PLY, STL or OFF file in it");
    if (!std::filesystem::is_regular_file(status))
        throw ModelError(place, "this is not a regular file", "name an OBJ, PLY, STL or OFF file");
    std::ifstream file(path, std::ios::binary);
    std::string bytes;
    if (file) {
        const auto size = std::filesystem::file_size(path, error);
        bytes.resize(error ? 0 : static_cast<std::size_t>(size));
        file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
    }
    if (!file.is_open() || file.bad())
        throw ModelError(place, "the file cannot be read", "check its permissions");
    if (bytes.empty())
        throw ModelError(place, "the file is empty", "copy or export it again");
    return bytes;
}

/// OpenMesh's talk is switched off while this lives.
class SilentOpenMesh {
  public:
    SilentOpenMesh() : errors_(omerr().is_enabled()), log_(omlog().is_enabled()) {
        omerr().disable();
        omlog().disable();
    }
    ~SilentOpenMesh() {
        if (errors_)
            omerr().enable();
        else
            omerr().disable();
        if (log_)
            omlog().enable();
        else
            omlog().disable();
    }
    SilentOpenMesh(const SilentOpenMesh&) = delete;
    SilentOpenMesh& operator=(const SilentOpenMesh&) = delete;

  private:
    bool errors_, log_;
};

Mesh importMesh(Format format, CheckedFile checked) {
    using Options = OpenMesh::IO::Options;
    FaceListImporter importer(static_cast<std::size_t>(checked.vertexCount),
                              static_cast<std::size_t>(checked.faceCount));
    Options options;
    if (checked.binary)
        options += Options::Binary;
    options += Options::VertexColor;
    options += Options::Custom;
    options += format == Format::obj ? Options::FaceTexCoord : Options::VertexTexCoord;
    std::istringstream stream(std::move(checked.bytes), std::ios::in | std::ios::binary);
    stream.imbue(std::locale::classic());

    // The readers are single objects with a memory of their last file.
    static std::mutex readers;
    const std::lock_guard<std::mutex> lock(readers);
    const SilentOpenMesh silence;
    bool good = false;
    switch (format) {
    case Format::obj:
        good = OpenMesh::IO::OBJReader().read(stream, importer, options);
        break;
    case Format::ply:
        good = OpenMesh::IO::PLYReader().read(stream, importer, options);
        break;
    case Format::stl:
        good = OpenMesh::IO::STLReader().read(stream, importer, options);
        break;
    case Format::off:
        good = OpenMesh::IO::OFFReader().read(stream, importer, options);
        break;
    }
    importer.setSharp(std::move(checked.creases), std::move(checked.corners));
    return good ? importer.takeMesh() : Mesh{};
}

/// A model without a surface cannot be coated.
void checkSurface(const Mesh& mesh, const std::string& place) {
    if (mesh.faceSizes.empty())
        throw ModelError(place, "the model has no faces with three or more different corners",
                         "export it as a mesh of triangles or polygons");
    double twiceArea = 0.0;
    std::size_t start = 0;
    for (const int size : mesh.faceSizes) {
        twiceArea += polygonAreaVector(mesh.positions, mesh.faceVertices.data() + start, size).length();
        start += static_cast<std::size_t>(size);
    }
    const V3f extent = mesh.bounds().size();
    const double longest = std::max({extent.x, extent.y, extent.z});
    // Rounding alone gives a needle an area of about 1e-7 of its length squared.
    if (!(longest > 0.0) || !(twiceArea > 1e-12 * longest * longest))
        throw ModelError(place,
                         longest > 0.0 ? "the model has no area: all its faces are lines or points"
                                       : "all of the model's vertices lie at one point",
                         "export it again, and check its scale");
}

} // namespace

Mesh readMesh(const std::filesystem::path& path) {
    const std::string place = path.string();
    std::error_code error;
    if (!std::filesystem::is_directory(path, error))
        formatOf(path); // a wrong name is told before a missing file's
    const std::string bytes = readBytes(path);
    const Format format = formatOf(path);
    CheckedFile checked;
    switch (format) {
    case Format::obj:
        checked = checkedObj(bytes, place);
        break;
    case Format::ply:
        checked = checkedPly(bytes, place);
        break;
    case Format::stl:
        checked = checkedStl(bytes, place);
        break;
    case Format::off:
        checked = checkedOff(bytes, place);
        break;
    }
    Mesh mesh = importMesh(format, std::move(checked));
    mesh.name = path.stem().string();
    checkSurface(mesh, place);
    return mesh;
}

} // namespace patina
