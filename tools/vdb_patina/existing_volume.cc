#include "existing_volume.h"

#include "data_folder.h"

#include "base/errors.h"
#include "script/interpreter.h"
#include "volume/vdb_file.h"

#include <fmt/format.h>

namespace patina::tool {

Options withUpOf(const std::string& volumeFile, Options options) {
    if (options.upGiven)
        return options;
    const std::string up = upAxisOf(volumeFile);
    if (!up.empty())
        options.up = up == "z" ? UpAxis::z : UpAxis::y;
    return options;
}

ExistingVolume loadExisting(const std::string& volumeFile, const std::string& modelName, const Options& given,
                            Console& console) {
    LayerVolume volume = readVolume(volumeFile);
    const Options options = withUpOf(volumeFile, given);
    const std::string modelFile = modelName.empty() ? modelBeside(volumeFile) : modelName;
    Model model = loadModel(modelFile, options, &volume.scale(), console, RegionRequest::of(volume, volumeFile));
    // How holes were dealt with is not asked for again where it can be found out.
    for (const char* repair : {"sheet", "holes"})
        if (options.repair.empty() && !model.region && !volume.provenance.modelHash.empty() &&
            surfaceHash(model.surface) != volume.provenance.modelHash) {
            Options other = options;
            other.repair = repair;
            model = loadModel(modelFile, other, &volume.scale(), console);
        }
    const bool isPiece = model.region && !model.whole;
    if (!isPiece && !volume.provenance.modelHash.empty() && surfaceHash(model.surface) != volume.provenance.modelHash)
        throw ModelError(
            modelFile,
            fmt::format("is not the model that '{}' was made from ('{}')", volumeFile, volume.provenance.model),
            "give the same model, with the same --subdivide, --scheme, --repair and --atlas");
    return {std::move(volume), std::move(model), MaterialLibrary::load(findDataFolder())};
}

} // namespace patina::tool
