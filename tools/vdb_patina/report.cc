#include "report.h"

#include "export/texel_map.h"
#include "optics/colour.h"
#include "surface/mesh_repair.h"
#include "volume/memory_formula.h"

#include <sys/resource.h>

#include <algorithm>

namespace patina::tool {

using Json = nlohmann::ordered_json;

namespace {

Json describe(const LayerStatistics& layer) {
    return {{"material", layer.material}, {"mean_um", layer.meanUm},    {"max_um", layer.maxUm},
            {"coverage", layer.coverage}, {"rq_um", layer.roughnessUm}, {"volume_m3", layer.volumeM3}};
}

Json describe(const GrowthStatistics& growth) {
    return {{"particles", growth.particles},
            {"arrivals", growth.arrivals},
            {"mean_layers", growth.mean},
            {"interface_width_layers", growth.interfaceWidth},
            {"skewness", growth.skewness},
            {"coverage", growth.coverage},
            {"density", growth.density},
            {"patches", growth.patches},
            {"level_um", growth.levelUm}};
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

Json describe(const MeshReport::Fault& fault) {
    return {{"count", fault.count}, {"first", fault.where}};
}

Json describe(const MeshReport& findings) {
    constexpr std::size_t most = 1000; // of shells and holes, so that the report stays readable
    Json json = {{"repaired", findings.repaired}};
    json["shell_count"] = findings.shells.size();
    json["shells"] = Json::array();
    for (std::size_t i = 0; i < std::min(most, findings.shells.size()); ++i) {
        const MeshReport::Shell& shell = findings.shells[i];
        json["shells"].push_back({{"kind", nameOf(shell.kind)},
                                  {"faces", shell.faces},
                                  {"area", shell.area},
                                  {"volume", shell.volume},
                                  {"turned_over", shell.turnedOver},
                                  {"turned_faces", shell.turnedFaces},
                                  {"open_edges", shell.openEdges},
                                  {"first_face", shell.firstFace + 1},
                                  {"at", {shell.place.x, shell.place.y, shell.place.z}}});
    }
    json["hole_count"] = findings.holes.size();
    json["holes"] = Json::array();
    for (std::size_t i = 0; i < std::min(most, findings.holes.size()); ++i) {
        const MeshReport::Hole& hole = findings.holes[i];
        json["holes"].push_back({{"closed", hole.closed},
                                 {"crack", hole.crack},
                                 {"edges", hole.edges},
                                 {"area", hole.area},
                                 {"vertex", hole.vertex + 1},
                                 {"at", {hole.centre.x, hole.centre.y, hole.centre.z}}});
    }
    json["turned_faces"] = describe(findings.turnedFaces);
    json["copied_faces"] = describe(findings.copiedFaces);
    json["flat_faces"] = describe(findings.flatFaces);
    json["edges_of_many_faces"] = describe(findings.crowdedEdges);
    json["pinched_vertices"] = describe(findings.pinchedVertices);
    json["one_sided_edges"] = describe(findings.oneSidedEdges);
    json["piercing_faces"] = describe(findings.piercedFaces);
    json["thin_walls"] = {{"fraction", findings.thinWalls.fraction},
                          {"thinnest_units", findings.thinWalls.thinnest},
                          {"where", findings.thinWalls.where}};
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
                        {"voxel_size_units", volume.scale().voxelSize / model.magnification()},
                        {"voxel_size_um", volume.scale().voxelSize * volume.scale().metresPerUnit * 1e6},
                        {"exaggeration", volume.scale().exaggeration}};
    for (const Parameter& parameter : program.parameters)
        report["inputs"]["parameters"][parameter.name] = parameter.value;
    report["model"] = describe(model.findings);
    report["surface"] = {{"triangles", model.surface.triangles.size()},
                         {"closed", model.surface.closed},
                         {"area_m2", stack.areaM2},
                         {"voxelization_error_rms_voxels", stack.voxelizationErrorVoxels},
                         {"unreadable_fraction", stack.unreadable}};
    report["volume"] = {{"active_voxels", volume.activeVoxels()},
                        {"leaves", volume.leafCount()},
                        {"bytes", volume.memoryBytes()},
                        {"leaf_value_bytes", leafValueBytes(volume)},
                        {"memory_of_formula", memoryOfFormula(volume)},
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
                      {"texels", summary.texels},
                      {"unreadable_fraction", summary.unreadableFraction},
                      {"fold_fraction", summary.foldFraction},
                      {"voxelisation_rms_voxels", summary.voxelisationRms},
                      {"voxelisation_max_voxels", summary.voxelisationMax},
                      {"supersampled_fraction", summary.supersampledFraction},
                      {"overlapping_fraction", summary.overlapFraction},
                      {"max_displacement_units", summary.maxDisplacement},
                      {"mean_colour_lab", {lab.x, lab.y, lab.z}},
                      {"green_fraction", summary.greenFraction}};
    report["maps"]["udims"] = Json::array();
    for (const Imath::V2i& tile : summary.tiles)
        report["maps"]["udims"].push_back(udimOf(tile));
}

Json makeBakeReport(const std::string& volumeFile, const LayerVolume& volume, const Model& model,
                    const Options& options) {
    Json report;
    report["schema"] = 1;
    report["program"] = "vdb-patina " PATINA_VERSION;
    report["inputs"] = {{"volume", volumeFile},
                        {"script", volume.provenance.scriptName},
                        {"model", model.name},
                        {"model_hash", volume.provenance.modelHash},
                        {"voxel_size_units", volume.scale().voxelSize / model.magnification()},
                        {"voxel_size_um", volume.scale().voxelSize * volume.scale().metresPerUnit * 1e6},
                        {"exaggeration", volume.scale().exaggeration},
                        {"resolution", options.resolution}};
    report["layers"] = volume.layers();
    report["content_hash"] = contentHash(volume);
    return report;
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
    // Of the process, the program and its libraries included.
    if (const auto volume = report.find("volume"); volume != report.end() && volume->contains("leaf_value_bytes"))
        (*volume)["peak_of_formula"] = peakMemoryBytes() / (1.15 * (*volume)["leaf_value_bytes"].get<double>());
    report["warnings"] = console.warnings();
    report["outputs"] = outputs;
}

} // namespace patina::tool
