#pragma once
// Runs a checked script on a model: one statement, one operator on the nest.

#include "base/progress.h"
#include "operators/growth/growth_statistics.h"
#include "operators/surface_operation.h"
#include "optics/material_library.h"
#include "script/checker.h"
#include "script/program.h"
#include "surface/mesh.h"
#include "volume/layer_statistics.h"
#include "volume/layer_volume.h"
#include "volume/region_context.h"
#include "volume/region_model.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

namespace patina {

/// What a run leaves to the next of a series, in which each opens the volume that the last has made of the same surface:
/// the model's points bound to the band, growth lattices, patterns, fields. Saves time and changes no bit.
struct RunSession {
    RunSession();
    ~RunSession();

    /// Gives back the volume of the last run (its result's), which has been written to `file` and is not changed since.
    void keep(const std::filesystem::path& file, LayerVolume volume);

    struct Kept;
    std::unique_ptr<Kept> kept; ///< the interpreter's
};

struct RunOptions {
    VolumeScale scale;            ///< of a `new` volume; `open` keeps the file's own
    double longestSide = 0.0;     ///< of the whole model, scene units: growth cells are 1/512 of it
    Imath::V3d up{0.0, 1.0, 0.0}; ///< of the model
    std::uint64_t seed = 0;
    std::string programVersion;
    std::string modelName;
    const RegionModel* region = nullptr;    ///< of a close-up; the surface given to runProgram() is then its shown()
    const ContextFields* context = nullptr; ///< of a close-up: the whole model's fields
    RunSession* session = nullptr;          ///< of a series; scale, up, seed and region must be those of its last run
};

/// What one statement did.
struct StatementReport {
    std::string text;
    int line = 0;
    double seconds = 0.0;
    OperationReport operation;
    std::vector<GrowthStatistics> growths;
    LayerStatistics stack; ///< of the whole stack afterwards
};

struct RunResult {
    std::optional<LayerVolume> volume;
    std::vector<StatementReport> statements; ///< those that were finished
    std::size_t finished = 0;                ///< statements of the program that are done
    bool interrupted = false;                ///< the volume holds what the finished statements made
    double voxelizeSeconds = 0.0;
};

/// Thickest the script can make the stack, in voxels of the volume: what the band must hold.
double thickestStackVoxels(const Program& program, const VolumeScale& scale);

/// Voxels outside the base that hold it: the stack (and what slopes read too much), and three to spare.
double bandOutsideVoxels(const Program& program, const VolumeScale& scale);

/// Deepest the script can erode the metal itself, in voxels, by hardnesses of 1 and more.
double deepestPitVoxels(const Program& program, const VolumeScale& scale);

/// What this build can do, for CheckContext: operators, functions, growth models.
void declareAbilities(CheckContext& context, const MaterialLibrary& materials);

/// Runs the program from its first statement, or, given `resume` and `finished`, from where an interrupted run stopped.
/// \param surface  must outlive the call
/// \throws ModelError, RunError; an interruption is no error here but `interrupted` in the result
RunResult runProgram(const Program& program, const SurfaceMesh& surface, const MaterialLibrary& materials,
                     const RunOptions& options, Progress& progress, std::optional<LayerVolume> resume = {},
                     std::size_t finished = 0);

/// Hash of a surface's positions and triangles: whether a volume belongs to a model.
std::string surfaceHash(const SurfaceMesh& surface);

} // namespace patina
