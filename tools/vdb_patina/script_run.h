#pragma once
// The parts of running a script that several commands share: checking it against its model, the budget, the results.

#include "console.h"
#include "model_input.h"
#include "options.h"

#include "optics/material_library.h"
#include "script/checker.h"
#include "script/interpreter.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace patina::tool {

/// A checked script and the model it runs on.
struct Task {
    Program program;
    Model model;
};

/// What this build and the command line give a script to work with.
CheckContext checkContext(const MaterialLibrary& materials, const Options& options);

/// Reads both. Everything that can be wrong with script, model and both together is told here, before anything is
/// written.
Task prepareTask(const std::string& script, const std::string& modelName, const MaterialLibrary& materials,
                 const Options& options, Console& console);

/// Reads another script for the same model: the next of a series, which opens the last one's volume.
void nextScript(Task& task, const std::string& script, const MaterialLibrary& materials, const Options& options,
                Console& console);

RunOptions runOptionsOf(const Task& task, const Options& options);

/// Says what the run needs. \throws Error (over budget) where that is more than allowed and not forced
void checkBudget(const Task& task, const Options& options, Console& console);

/// Volume, maps, meshes, picture and report of a run that is done.
/// \param earlier  statements that a resumed run had finished before
void writeResults(const Task& task, const RunResult& result, const nlohmann::ordered_json& earlier,
                  const MaterialLibrary& materials, const Options& options, const std::filesystem::path& folder,
                  Console& console);

/// Warns where a map left 0…1.
void warnAboutClamping(const RunResult& result, Console& console);

} // namespace patina::tool
