#pragma once
// report.json: what went in, what came out, how long it took.

#include "console.h"
#include "export/bake.h"
#include "model_input.h"
#include "options.h"
#include "script/interpreter.h"
#include "volume/layer_statistics.h"

#include <nlohmann/json.hpp>

#include <string>

namespace patina::tool {

/// All but the stages' times, the peak memory and the outputs, which finishReport() adds.
/// \param earlier  statements that a resumed run had finished before, as describeStatements() gave them
nlohmann::ordered_json makeReport(const Program& program, const Model& model, const Options& options,
                                  const RunResult& run, const StackStatistics& stack,
                                  const nlohmann::ordered_json& earlier = nlohmann::ordered_json::array());

/// The report's array of statements.
nlohmann::ordered_json describeStatements(const std::vector<StatementReport>& statements);

/// The same for `bake`: what was read.
nlohmann::ordered_json makeBakeReport(const std::string& volumeFile, const LayerVolume& volume, const Model& model,
                                      const Options& options);

void addMapsToReport(nlohmann::ordered_json& report, const BakeSummary& summary);
void finishReport(nlohmann::ordered_json& report, const Console& console, const std::vector<std::string>& outputs);

/// Most memory this process has had, bytes.
double peakMemoryBytes();

} // namespace patina::tool
