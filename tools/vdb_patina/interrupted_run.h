#pragma once
// What an interrupted run leaves behind, so that `run --resume` can go on.

#include "model_input.h"
#include "script/interpreter.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace patina::tool {

/// Two files in the output folder, NAME.interrupted.vdb and NAME.interrupted.json: the volume after the last finished
/// statement, how many there were, and their part of the report.
class InterruptedRun {
  public:
    InterruptedRun(const std::filesystem::path& folder, const std::string& name);

    struct State {
        LayerVolume volume;
        std::size_t finished = 0;
        nlohmann::ordered_json statements; ///< the report of the finished ones
    };

    /// Does nothing where no statement was finished. \return whether there is something to go on from
    bool save(const RunResult& result, const nlohmann::ordered_json& statements, const std::string& inputs) const;
    /// \throws Error where there is none, it is damaged, or of other inputs
    State load(const std::string& inputs) const;
    void remove() const;

  private:
    std::filesystem::path volumeFile_, stateFile_;
};

/// Hash of all that the finished statements depend on.
std::string hashOfInputs(const Program& program, const Model& model, const RunOptions& run);

} // namespace patina::tool
