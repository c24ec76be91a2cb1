#pragma once
// What several commands make from a volume and its model: maps, meshes.

#include "base/atomic_file.h"
#include "console.h"
#include "export/bake.h"
#include "model_input.h"
#include "optics/layer_stack.h"
#include "optics/material_library.h"
#include "options.h"
#include "volume/layer_volume.h"
#include "volume/vdb_file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patina::tool {

/// The optics of a volume's metal and layers. \throws RunError where a material is not in the library
StackOptics opticsOf(const LayerVolume& volume, const MaterialLibrary& materials, const Options& options);

/// What the options say of a .vdb.
VolumeFileOptions volumeFileOptions(const Options& options);

/// The folder for results: -o, or one named after the result. Made, and checked for being writable; gone again where
/// nothing is written in it.
OutputFolder outputFolder(const Options& options, const std::string& name);

/// Where the report goes: --report, or NAME in the folder; found out before the work is done that it can be written.
/// \throws RunError where it cannot
std::filesystem::path reportFile(const Options& options, const std::filesystem::path& folder,
                                 const std::string& name = "report.json");

/// Bakes and writes all maps, and NAME.usda and NAME.mtlx that read them.
/// \param volumeFile  where the volume lies, and what names the scene; empty: NAME.vdb in the folder, NAME the script's
/// \return their summary; file names are appended to `outputs`
BakeSummary writeMaps(const LayerVolume& volume, const Model& model, const StackOptics& optics, const Options& options,
                      const std::filesystem::path& folder, std::vector<std::string>& outputs, Console& console,
                      const std::filesystem::path& volumeFile = {});

/// NAME.obj (control mesh; with normals where it is not subdivided) and NAME_limit.ply.
void writeMeshes(const Model& model, const Options& options, const std::string& name,
                 const std::filesystem::path& folder, std::vector<std::string>& outputs, Console& console);

/// NAME_micro.ply, where it is asked for (export/micro_mesh.h).
void writeMicroMesh(const LayerVolume& volume, const Model& model, const StackOptics& optics, const Options& options,
                    const std::string& name, const std::filesystem::path& folder, std::vector<std::string>& outputs,
                    Console& console);

} // namespace patina::tool
