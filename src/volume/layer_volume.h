#pragma once
// The state of a patina: a nest of level sets around the bare metal.
//
//        air            phi_n  = surface
//     ~~~~~~~~~~~~~~~~  phi_2        region k = { phi_k <= 0 < phi_{k-1} }
//     ----------------  phi_1        phi_k <= phi_{k-1} everywhere
//     ================  phi_0 = base, the bare metal as it was
//
// This header is free of OpenVDB; sources that work on the grids include "volume/nest_grids.h" as well.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace patina {

struct NestGrids;

/// What fixes the relation between scripts (µm), the model (scene units) and the lattice (voxels).
struct VolumeScale {
    double voxelSize = 0.0;     ///< scene units
    double metresPerUnit = 1.0; ///< of the model
    double exaggeration = 1.0;  ///< thickness in the volume over real thickness

    /// Scene units drawn in the volume for one real micrometre of thickness.
    double unitsPerUm() const { return 1e-6 / metresPerUnit * exaggeration; }
    double voxelsPerUm() const { return unitsPerUm() / voxelSize; }
};

/// Base, interfaces, material IDs and fields of one object, and where they came from. Movable; clone() copies.
///
/// All grids share one active topology, the band. Interfaces may lie closer together than any fraction of a
/// voxel; nothing ever re-distances them near their zero crossing.
class LayerVolume {
  public:
    /// A volume with no layers around the given grids. Used by voxelize() and by the reader.
    LayerVolume(VolumeScale scale, std::string metal, std::unique_ptr<NestGrids> grids);
    ~LayerVolume();
    LayerVolume(LayerVolume&&) noexcept;
    LayerVolume& operator=(LayerVolume&&) noexcept;

    LayerVolume clone() const;

    const VolumeScale& scale() const { return scale_; }

    /// Layers above the metal, bottom to top: material names.
    const std::vector<std::string>& layers() const { return layers_; }
    int layerCount() const { return static_cast<int>(layers_.size()); }
    const std::string& metal() const { return palette_[1]; }

    /// Material ID to name: palette()[0] = "air", [1] = the metal.
    const std::vector<std::string>& palette() const { return palette_; }
    /// The ID of a material, added to the palette where it is new.
    std::int32_t materialId(const std::string& material);
    /// The ID of a material in the palette; 0 where it is not there.
    std::int32_t findMaterialId(const std::string& material) const;

    /// Name of layer k's interface grid (k from 1): "interface_02_cuprite_2".
    std::string interfaceGridName(int k) const;

    NestGrids& grids() { return *grids_; }
    const NestGrids& grids() const { return *grids_; }

    /// Puts a layer on top whose interface equals the present surface (zero thickness everywhere).
    void pushLayer(const std::string& material);
    /// Names the layer whose interface a caller has put on top of the grids itself.
    void nameTopLayer(const std::string& material);
    /// Makes two layers of layer k (k from 1): k keeps its material, k + 1 above it is of `outer` and has zero thickness
    /// everywhere, both interfaces being what k's was.
    void splitLayer(int k, const std::string& outer);
    /// Removes layer k (k from 1) and its interface. What lies above must touch what lies below.
    void removeLayer(int k);

    /// Provenance: what is written as `patina_…` metadata besides what this class knows itself.
    struct Provenance {
        std::string script; ///< the script's text
        std::string scriptName;
        std::string model;     ///< file name of the model
        std::string modelHash; ///< content hash of the model's surface
        std::string program;   ///< version of the program
        std::uint64_t seed = 0;
        std::string region; ///< Region::text() where the volume is a box cut out of the model; otherwise empty
    };
    Provenance provenance;

    std::size_t activeVoxels() const;
    std::size_t leafCount() const;
    /// Bytes of all grids.
    std::size_t memoryBytes() const;

  private:
    VolumeScale scale_;
    std::vector<std::string> palette_;
    std::vector<std::string> layers_;
    std::unique_ptr<NestGrids> grids_;
};

/// Hash of the values of all grids (topology, base, interfaces, IDs, fields) and of the palette: equal
/// for equal results, whatever the number of threads.
std::string contentHash(const LayerVolume& volume);

} // namespace patina
