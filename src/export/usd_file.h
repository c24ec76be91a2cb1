#pragma once
// The result as a USD scene in text (.usda): mesh, material with the baked maps, volume.
//
//   /NAME                      Xform, component, the default prim
//     /Surface                 Mesh: the control mesh, its subdivision scheme, creases, UVs as primvars:st
//     /Materials/Patina        UsdPreviewSurface and a MaterialX network (Standard Surface), both displaced
//     /Volume                  Volume, invisible until asked for: one OpenVDBAsset per grid
//
// Paths are relative to the scene's own folder. The text is a function of the description alone.

#include "export/material_maps.h"
#include "surface/mesh.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patina {

/// A grid of the .vdb as UsdVol names it.
struct UsdField {
    std::string grid;     ///< "interface_01_tarnish_1"
    bool integer = false; ///< int32; otherwise float
    bool levelSet = false;
};

struct UsdScene {
    std::string name;            ///< of the root prim; what USD does not take as a name is replaced by '_'
    const Mesh* mesh = nullptr;  ///< the control mesh that the maps belong to
    std::string scheme = "none"; ///< subdivisionScheme: none, catmullClark or loop
    const std::vector<Imath::V3f>* normals = nullptr; ///< per vertex, for meshes that are not subdivided; may be null
    double metresPerUnit = 1.0;
    bool zUp = false;
    MaterialMaps maps;               ///< none baked: no material
    std::string volumeFile;          ///< relative to the scene; empty: no volume
    double volumeUnitsPerUnit = 1.0; ///< the volume's units per unit of the mesh (magnified close-ups)
    std::vector<UsdField> fields;
    std::string documentation; ///< one line: what made it, from what
};

/// \throws RunError where the mesh is missing or normals are given that are not one per vertex
std::string usdText(const UsdScene& scene);

/// Writes it atomically. \throws RunError
void writeUsd(const UsdScene& scene, const std::filesystem::path& path);

} // namespace patina
