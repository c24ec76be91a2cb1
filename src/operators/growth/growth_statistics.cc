#include "operators/growth/growth_statistics.h"

#include <cmath>

namespace patina {

namespace {

std::size_t countPatches(const GrowthLattice& lattice, const std::vector<float>& heights) {
    std::vector<char> seen(lattice.size(), 0);
    std::vector<int> open;
    std::size_t patches = 0;
    for (std::size_t start = 0; start < lattice.size(); ++start) {
        if (seen[start] || heights[start] <= 0.f)
            continue;
        ++patches;
        seen[start] = 1;
        open.push_back(static_cast<int>(start));
        while (!open.empty()) {
            const int cell = open.back();
            open.pop_back();
            for (int next : lattice.neighbours[cell]) {
                if (next == GrowthLattice::noCell || seen[next] || heights[next] <= 0.f)
                    continue;
                seen[next] = 1;
                open.push_back(next);
            }
        }
    }
    return patches;
}

} // namespace

GrowthStatistics measureHeights(const GrowthLattice& lattice, const std::vector<float>& heights) {
    GrowthStatistics result;
    // Sums run in the order of the cells, so that they do not depend on the number of threads.
    double area = 0.0, covered = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < lattice.size(); ++i) {
        area += lattice.areas[i];
        sum += double(lattice.areas[i]) * heights[i];
        if (heights[i] > 0.f)
            covered += lattice.areas[i];
    }
    if (area <= 0.0)
        return result;
    result.mean = sum / area;
    result.coverage = covered / area;
    double second = 0.0, third = 0.0;
    for (std::size_t i = 0; i < lattice.size(); ++i) {
        const double d = heights[i] - result.mean;
        second += lattice.areas[i] * d * d;
        third += lattice.areas[i] * d * d * d;
    }
    second /= area;
    third /= area;
    result.interfaceWidth = std::sqrt(second);
    result.skewness = second > 0.0 ? third / (second * result.interfaceWidth) : 0.0;
    result.patches = countPatches(lattice, heights);
    return result;
}

} // namespace patina
