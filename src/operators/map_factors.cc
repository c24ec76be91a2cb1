#include "operators/map_factors.h"

#include "volume/nest_grids.h"

#include <tbb/parallel_for.h>

namespace patina {

double clampedFactor(const ThicknessMap& map, const SurfaceMesh& surface, const SurfacePoint& under,
                     ClampedFactors& clamped) {
    MapPoint point;
    point.position = positionAt(surface, under);
    point.normal = normalAt(surface, under);
    point.triangle = under.triangle;
    point.u = under.u;
    point.v = under.v;
    const double factor = map.value(point);
    if (factor < 0.0) {
        ++clamped.below;
        return 0.0;
    }
    if (!(factor <= 1.0)) {
        ++clamped.above;
        return 1.0;
    }
    return factor;
}

std::vector<float> baseFactors(const Workpiece& work, const ThicknessMap* map, OperationReport& report,
                               Progress& progress) {
    const SurfaceBinding& binding = work.binding;
    const std::size_t leaves = work.volume.leafCount();
    std::vector<float> factors(binding.leafStart(leaves), 0.f);
    std::vector<ClampedFactors> clamped(leaves);
    tbb::parallel_for(std::size_t(0), leaves, [&](std::size_t n) {
        if (progress.cancelled())
            return;
        for (std::size_t at = binding.leafStart(n); at < binding.leafStart(n + 1); ++at) {
            const SurfacePoint& under = binding.at(at);
            if (under.triangle >= 0)
                factors[at] =
                    map ? static_cast<float>(clampedFactor(*map, binding.surface(), under, clamped[n])) : 1.f;
        }
    });
    progress.checkpoint();
    for (const ClampedFactors& c : clamped) {
        report.clampedBelow += c.below;
        report.clampedAbove += c.above;
    }
    return factors;
}

} // namespace patina
