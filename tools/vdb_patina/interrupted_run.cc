#include "interrupted_run.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "base/hash.h"
#include "volume/vdb_file.h"

#include <fmt/format.h>

namespace patina::tool {

namespace fs = std::filesystem;

InterruptedRun::InterruptedRun(const fs::path& folder, const std::string& name)
    : volumeFile_(folder / (name + ".interrupted.vdb")), stateFile_(folder / (name + ".interrupted.json")) {}

bool InterruptedRun::save(const RunResult& result, const nlohmann::ordered_json& statements,
                          const std::string& inputs) const {
    if (!result.volume || result.finished == 0)
        return false;
    // The state names the volume's content: a volume of this run and a state of another are no pair.
    writeVolume(*result.volume, volumeFile_);
    const nlohmann::ordered_json state = {{"inputs", inputs},
                                          {"content_hash", contentHash(*result.volume)},
                                          {"finished", result.finished},
                                          {"statements", statements}};
    writeTextFile(stateFile_, state.dump(2) + "\n");
    return true;
}

InterruptedRun::State InterruptedRun::load(const std::string& inputs) const {
    const std::string remedy = "start anew, without --resume";
    if (!fs::exists(stateFile_))
        throw Error(
            ExitCode::commandLine, "--resume",
            fmt::format("there is no interrupted run of this script in '{}'", stateFile_.parent_path().string()),
            remedy);
    const auto state = nlohmann::ordered_json::parse(readTextFile(stateFile_), nullptr, false);
    const auto holds = [&](const char* key, bool (nlohmann::ordered_json::*is)() const noexcept) {
        return state.is_object() && state.contains(key) && (state[key].*is)();
    };
    using Json = nlohmann::ordered_json;
    if (!holds("inputs", &Json::is_string) || !holds("content_hash", &Json::is_string) ||
        !holds("finished", &Json::is_number_unsigned) || !holds("statements", &Json::is_array))
        throw RunError(stateFile_.string(), "is damaged", remedy);
    if (state["inputs"] != inputs)
        throw Error(ExitCode::commandLine, "--resume",
                    fmt::format("'{}' is of another script, model or options", stateFile_.string()),
                    "give those of the interrupted run, or " + remedy);
    State loaded{readVolume(volumeFile_), state["finished"].get<std::size_t>(), state["statements"]};
    if (contentHash(loaded.volume) != state["content_hash"])
        throw RunError(volumeFile_.string(), fmt::format("does not belong to '{}'", stateFile_.string()), remedy);
    return loaded;
}

void InterruptedRun::remove() const {
    std::error_code ignored;
    fs::remove(volumeFile_, ignored);
    fs::remove(stateFile_, ignored);
}

std::string hashOfInputs(const Program& program, const Model& model, const RunOptions& run) {
    ContentHash hash;
    hash.add(program.sourceText);
    for (const Parameter& parameter : program.parameters)
        hash.add(&parameter.value, sizeof parameter.value);
    hash.add(surfaceHash(model.surface));
    hash.add(&run.scale.voxelSize, sizeof run.scale.voxelSize);
    hash.add(&run.scale.metresPerUnit, sizeof run.scale.metresPerUnit);
    hash.add(&run.scale.exaggeration, sizeof run.scale.exaggeration);
    hash.add(&run.up, sizeof run.up);
    hash.add(&run.seed, sizeof run.seed);
    return hash.text();
}

} // namespace patina::tool
