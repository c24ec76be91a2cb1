#include "report.h"

#include "optics/colour.h"

#include <sys/resource.h>

namespace patina::tool {

using Json = nlohmann::ordered_json;

namespace {

Json describe(const LayerStatistics& layer) {
    return {{"material", layer.material}, {"mean_um", layer.meanUm},    {"max_um", layer.maxUm},
            {"coverage", layer.coverage}, {"rq_um", layer.roughnessUm}, {"volume_m3", layer.volumeM3}};
}

Json describe(const GrowthStatistics& growth) {
    return {{"particles", growth.particles},
            {"mean_layers", growth.mean},
            {"interface_width_layers", growth.interfaceWidth},
            {"skewness", growth.skewness},
            {"coverage", growth.coverage},
            {"density", growth.density},
            {"patches", growth.patches}};
}

Json describe(const StatementReport& statement) {
    Json json = {{"line", statement.line}, {"text", statement.text}, {"seconds", statement.seconds}};
    if (!statement.stack.material.empty())
        json["stack"] = {{"mean_um", statement.stack.meanUm},
                         {"max_um", statement.stack.maxUm},
                         {"coverage", statement.stack.coverage},
                         {"rq_um", statement.stack.roughnessUm},
                         {"volume_m3", statement.stack.volumeM3}};
    json["changed_material_ids"] = statement.operation.changedIds;
    if (statement.operation.clampedBelow + statement.operation.clampedAbove > 0)
        json["map_clamped_voxels"] = statement.operation.clampedBelow + statement.operation.clampedAbove;
    for (const GrowthStatistics& growth : statement.growths)
        json["growths"].push_back(describe(growth));
    return json;
}

} // namespace

Json describeStatements(const std::vector<StatementReport>& statements) {
    Json json = Json::array();
    for (const StatementReport& statement : statements)
        json.push_back(describe(statement));
    return json;
}

Json makeReport(const Program& program, const Model& model, const Options& options, const RunResult& run,
                const StackStatistics& stack, const Json& earlier) {
    const LayerVolume& volume = *run.volume;
    Json report;
    report["schema"] = 1;
    report["program"] = "vdb-patina " PATINA_VERSION;
    report["inputs"] = {{"script", program.file},
                        {"model", model.name},
                        {"model_hash", volume.provenance.modelHash},
                        {"seed", volume.provenance.seed},
                        {"unit", options.unit},
                        {"voxel_size_units", volume.scale().voxelSize},
                        {"voxel_size_um", volume.scale().voxelSize * volume.scale().metresPerUnit * 1e6},
                        {"exaggeration", volume.scale().exaggeration}};
    for (const Parameter& parameter : program.parameters)
        report["inputs"]["parameters"][parameter.name] = parameter.value;
    report["surface"] = {{"triangles", model.surface.triangles.size()},
                         {"closed", model.surface.closed},
                         {"area_m2", stack.areaM2},
                         {"voxelization_error_rms_voxels", stack.voxelizationErrorVoxels},
                         {"unreadable_fraction", stack.unreadable}};
    report["volume"] = {{"active_voxels", volume.activeVoxels()},
                        {"leaves", volume.leafCount()},
                        {"bytes", volume.memoryBytes()},
                        {"palette", volume.palette()}};
    report["statements"] = earlier;
    for (const StatementReport& statement : run.statements)
        report["statements"].push_back(describe(statement));
    if (!earlier.empty())
        report["resumed_after_statements"] = earlier.size();
    report["layers"] = Json::array();
    for (const LayerStatistics& layer : stack.layers)
        report["layers"].push_back(describe(layer));
    report["stack"] = describe(stack.total);
    report["content_hash"] = contentHash(volume);
    return report;
}

void addMapsToReport(Json& report, const BakeSummary& summary) {
    const Imath::V3d lab = labFromXyz(xyzFromLinearRec709(summary.meanColour));
    report["maps"] = {{"covered_fraction", summary.coveredFraction},
                      {"unreadable_fraction", summary.unreadableFraction},
                      {"max_displacement_units", summary.maxDisplacement},
                      {"mean_colour_lab", {lab.x, lab.y, lab.z}},
                      {"green_fraction", summary.greenFraction}};
}

double peakMemoryBytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) * 1024.0;
}

void finishReport(Json& report, const Console& console, const std::vector<std::string>& outputs) {
    report["stages"] = Json::array();
    double total = 0.0;
    for (const Console::Stage& stage : console.stages()) {
        report["stages"].push_back({{"name", stage.name}, {"seconds", stage.seconds}});
        total += stage.seconds;
    }
    report["seconds"] = total;
    report["peak_memory_bytes"] = peakMemoryBytes();
    report["warnings"] = console.warnings();
    report["outputs"] = outputs;
}

} // namespace patina::tool
