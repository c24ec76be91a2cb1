#include "script/budget.h"

#include "script/interpreter.h"

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

// The layers of a script by their materials, as its operators pile them up.
class Pile {
  public:
    void lay(const std::string& material) {
        if (layers_.empty() || layers_.back() != material)
            layers_.push_back(material);
        most_ = std::max(most_, layers_.size());
    }

    void convert(const std::string& from, const std::string& to) {
        std::vector<std::string> converted;
        const auto add = [&](const std::string& material) {
            if (converted.empty() || converted.back() != material)
                converted.push_back(material);
        };
        std::size_t split = layers_.size();
        for (const std::string& layer : layers_) {
            add(layer);
            if (layer == from && from != to) {
                add(to);
                ++split;
            }
        }
        layers_ = converted;
        most_ = std::max(most_, split); // before neighbours are merged
    }

    std::size_t most() const { return most_; }

  private:
    std::vector<std::string> layers_;
    std::size_t most_ = 0;
};

// Bytes per active voxel that the hungriest operator needs beside the grids.
double workingBytesPerVoxel(const Program& program, const VolumeScale& scale) {
    const double perUm = scale.voxelsPerUm();
    double most = 0.0;
    for (const Statement& statement : program.statements) {
        double bytes = 0.0;
        // Thickness and slope of a shift; the distance and its foot where it is thicker than a voxel.
        const auto shift = [&](double um) { bytes = um * perUm > 1.0 ? 8.0 + 16.0 : 8.0; };
        if (const auto* coat = std::get_if<Coat>(&statement.action))
            shift(coat->thicknessUm);
        else if (const auto* erode = std::get_if<Erode>(&statement.action))
            shift(erode->thicknessUm);
        else if (std::holds_alternative<Grow>(statement.action))
            bytes = 6.0;
        else if (const auto* convert = std::get_if<Convert>(&statement.action))
            bytes = convert->map ? 4.0 : 0.0;
        else if (const auto* fill = std::get_if<Fill>(&statement.action))
            bytes = fill->aboveSmoothRadiusUm ? 24.0 : fill->map ? 4.0 : 0.0;
        else if (const auto* polish = std::get_if<Polish>(&statement.action))
            bytes = polish->map || polish->windowUm ? 4.0 : 0.0;
        else if (std::holds_alternative<Offset>(statement.action))
            bytes = 24.0;
        most = std::max(most, bytes);
    }
    return most;
}

} // namespace

int mostLevelSets(const Program& program) {
    Pile pile;
    int floor = 1;
    for (const Statement& statement : program.statements) {
        if (const auto* coat = std::get_if<Coat>(&statement.action))
            pile.lay(coat->material);
        else if (const auto* fill = std::get_if<Fill>(&statement.action))
            pile.lay(fill->material);
        else if (const auto* offset = std::get_if<Offset>(&statement.action))
            pile.lay(offset->material);
        else if (const auto* convert = std::get_if<Convert>(&statement.action))
            pile.convert(convert->from, convert->to);
        else if (const auto* erode = std::get_if<Erode>(&statement.action); erode && erode->andMetal)
            floor = 2;
    }
    return floor + static_cast<int>(pile.most());
}

Budget estimateBudget(const Program& program, const SurfaceMesh& surface, const VolumeScale& scale, int mapResolution) {
    Budget budget;
    const double levelSets = mostLevelSets(program);
    const double interiorBand = std::max(4.0, std::ceil(deepestPitVoxels(program, scale)) + 3.0);
    const double exteriorBand = bandOutsideVoxels(program, scale);
    // A sheet's back and front both carry a band.
    const double sides = surface.closed ? 1.0 : 2.0;
    const double area = sides * surface.area() / (scale.voxelSize * scale.voxelSize);
    const double width = interiorBand + exteriorBand;
    budget.activeVoxels = area * width;
    budget.allocatedVoxels = area * (width + 12.0);
    constexpr double bytesPerValue = 4.0 * 1.03; // a leaf's masks and node are 3 % of its values
    budget.volumeBytes = budget.allocatedVoxels * bytesPerValue * (levelSets + 1.0);
    const double texels = static_cast<double>(mapResolution) * mapResolution;
    const double bytesPerTexel = 4.0 + 12.0 * levelSets + 16.0 + 12.0;
    budget.mapBytes = texels * bytesPerTexel;
    // While it runs: a closest point per voxel, what the operators need, triangles with their trees, the program.
    constexpr double programBytes = 150e6, bytesPerTriangle = 400.0;
    const double working = budget.activeVoxels * (12.0 + workingBytesPerVoxel(program, scale));
    const double model = static_cast<double>(surface.triangles.size()) * bytesPerTriangle;
    budget.peakBytes = programBytes + model + budget.volumeBytes + std::max(working, budget.mapBytes);
    budget.diskBytes = budget.allocatedVoxels * 4.0 * (levelSets + 2.0) + budget.mapBytes;
    return budget;
}

} // namespace patina
