#include "operators/growth/growth_options.h"

#include <array>
#include <cmath>
#include <utility>

namespace patina {

namespace {

constexpr std::array<std::pair<std::string_view, GrowthModel>, 6> modelNames = {{
    {"ST", GrowthModel::steadyThickening},
    {"RD", GrowthModel::randomDeposition},
    {"RDR", GrowthModel::relaxation},
    {"BD", GrowthModel::ballisticDeposition},
    {"DPD", GrowthModel::directedPercolation},
    {"DPD_BS", GrowthModel::barabasiStanley},
}};

} // namespace

std::optional<GrowthModel> growthModelNamed(std::string_view name) {
    for (const auto& [word, model] : modelNames)
        if (word == name)
            return model;
    return std::nullopt;
}

std::vector<std::string> growthModelNames() {
    std::vector<std::string> names;
    for (const auto& entry : modelNames)
        names.emplace_back(entry.first);
    return names;
}

std::string growthModelName(GrowthModel model) {
    for (const auto& [word, entry] : modelNames)
        if (entry == model)
            return std::string(word);
    return {};
}

double pointSpacingFor(int points, double area, double cell) {
    // A saturated Poisson-disk set of least distance r has 0.70 points per r² of a plane; ours, of one candidate to a
    // block, 0.62 (measured on spheres).
    return points > 0 && area > 0.0 && cell > 0.0 ? std::sqrt(0.62 * area / points) / cell : 1.0;
}

} // namespace patina
