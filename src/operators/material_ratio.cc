#include "operators/material_ratio.h"

#include "operators/map_factors.h"
#include "operators/polish.h"
#include "operators/surface_samples.h"
#include "volume/stack_probe.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace patina {

namespace {

constexpr double everywhere = std::numeric_limits<double>::infinity();

// What is read at one point of the surface. Heights in scene units as drawn, above the bare metal: as the cut has them
// and thicknesses are measured, by phi_0.
struct Sample {
    Imath::V3f position, normal;
    float factor = 1.f; ///< of the map
    bool found = false;
    double height = 0.0;
    double from = 0.0, to = 0.0; ///< the material shows where the surface stands at heights in (from, to]
};

// Which height the cut leaves at a place of height z.
double heightAfter(double z, double factor, double cut) {
    return z > cut ? z - factor * (z - cut) : z;
}

// The cut that leaves height `after` at a place of height z; everywhere where no cut is needed.
double cutFor(double z, double factor, double after) {
    if (after >= z)
        return everywhere;
    return factor > 0.0 ? z - (z - after) / factor : -everywhere;
}

struct Solution {
    double cut = everywhere;
    double fraction = 0.0;
};

// Smc: from the highest place down until the factors of those at or above the cut come to the fraction.
Solution cutToPlateau(const std::vector<Sample>& samples, std::vector<std::uint32_t>& chosen, double fraction) {
    std::sort(chosen.begin(), chosen.end(), [&](std::uint32_t a, std::uint32_t b) {
        return samples[a].height != samples[b].height ? samples[a].height > samples[b].height : a < b;
    });
    const double wanted = fraction * static_cast<double>(chosen.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const Sample& here = samples[chosen[i]];
        const double next = sum + here.factor;
        if (next >= wanted) {
            // Each place stands for its share of the area: between the middles of two shares the height is linear.
            const double share = here.factor > 0.f ? (wanted - sum) / here.factor : 0.0;
            const std::size_t other = share < 0.5 ? (i > 0 ? i - 1 : i) : std::min(i + 1, chosen.size() - 1);
            const double cut = here.height + (samples[chosen[other]].height - here.height) * std::abs(share - 0.5);
            return {wanted <= 0.0 ? everywhere : cut, fraction};
        }
        sum = next;
    }
    if (chosen.empty())
        return {};
    return {samples[chosen.back()].height, sum / static_cast<double>(chosen.size())};
}

// Down from the highest place: the first cut that shows the material on the fraction, or the one that shows most.
Solution cutToMaterial(const std::vector<Sample>& samples, const std::vector<std::uint32_t>& chosen, double fraction) {
    struct Event {
        double cut;
        int change; ///< +1: shows at and below this cut; -1: no longer shows at and below
    };
    std::vector<Event> events;
    int showing = 0;
    for (const std::uint32_t i : chosen) {
        const Sample& here = samples[i];
        if (here.from >= here.to)
            continue;
        const double begin = cutFor(here.height, here.factor, here.to);
        const double end = cutFor(here.height, here.factor, here.from);
        if (end == everywhere)
            continue; // what stands there is lower
        if (begin == everywhere)
            ++showing;
        else
            events.push_back({begin, 1});
        events.push_back({end, -1});
    }
    std::sort(events.begin(), events.end(),
              [](const Event& a, const Event& b) { return a.cut != b.cut ? a.cut > b.cut : a.change > b.change; });
    const double count = std::max<double>(1.0, static_cast<double>(chosen.size()));
    Solution best{everywhere, showing / count};
    for (const Event& event : events) {
        if (best.fraction >= fraction || event.cut < 0.0)
            break;
        showing += event.change;
        if (showing / count > best.fraction)
            best = {event.cut, showing / count};
    }
    return best;
}

// Between which heights of the surface the material shows: above what lies below it by a nanometre, up to the top of
// its layer. Where it lies in several layers, in the highest.
void findMaterial(Sample& sample, const LayerVolume& volume, const std::string& material, double metalHeight,
                  const double* thicknessUm) {
    const double perUm = volume.scale().unitsPerUm(), nanometre = 1e-3 * perUm;
    double floor = metalHeight;
    bool shows = volume.metal() == material;
    sample.from = shows ? -everywhere : everywhere;
    sample.to = shows ? everywhere : -everywhere;
    for (int k = 0; k < volume.layerCount(); ++k) {
        if (thicknessUm[k] <= 1e-3)
            continue;
        const bool isIt = volume.layers()[k] == material;
        if (shows && !isIt)
            sample.to = floor + nanometre;
        if (isIt && !shows)
            sample.from = floor + nanometre;
        if (isIt)
            sample.to = everywhere;
        shows = isIt;
        floor += thicknessUm[k] * perUm;
    }
}

std::vector<Sample> readSamples(const Workpiece& work, const AreaPolish& what, std::size_t count,
                                OperationReport& report, Progress& progress) {
    const SurfaceMesh& surface = work.binding.surface();
    const StackProbe probe(work.volume);
    const std::vector<SurfacePoint> points = evenSamples(surface, count);
    std::vector<Sample> samples(points.size());
    constexpr std::size_t block = 1024;
    const std::size_t blocks = (points.size() + block - 1) / block;
    std::vector<ClampedFactors> clamped(blocks);
    tbb::parallel_for(std::size_t(0), blocks, [&](std::size_t b) {
        if (progress.cancelled())
            return;
        std::vector<double> thicknessUm(static_cast<std::size_t>(work.volume.layerCount()) + 1);
        for (std::size_t i = b * block; i < std::min(points.size(), (b + 1) * block); ++i) {
            Sample& sample = samples[i];
            const Imath::V3d position = positionAt(surface, points[i]), normal = normalAt(surface, points[i]);
            const auto reading = probe.read(position, normal, thicknessUm.data());
            sample.position = Imath::V3f(position);
            sample.normal = Imath::V3f(normal);
            sample.found = reading.found;
            sample.height = reading.distance;
            if (what.map)
                sample.factor = static_cast<float>(clampedFactor(*what.map, surface, points[i], clamped[b]));
            if (!what.ofMaterial.empty())
                findMaterial(sample, work.volume, what.ofMaterial, reading.metalDistance, thicknessUm.data());
        }
    });
    progress.checkpoint();
    for (const ClampedFactors& c : clamped) {
        report.clampedBelow += c.below;
        report.clampedAbove += c.above;
    }
    return samples;
}

Solution solve(const std::vector<Sample>& samples, std::vector<std::uint32_t>& chosen, const AreaPolish& what) {
    Solution solution = what.ofMaterial.empty() ? cutToPlateau(samples, chosen, what.fraction)
                                                : cutToMaterial(samples, chosen, what.fraction);
    solution.cut = std::max(solution.cut, 0.0);
    return solution;
}

// Points by the cell of a cubic lattice they lie in.
class PointCells {
  public:
    PointCells(double pitch) : pitch_(pitch) {}

    void add(const Imath::V3f& position, std::uint32_t index) { cells_[key(cell(position))].push_back(index); }

    // Calls visit(index) for all points in the cells around a position; one pitch away is always among them.
    template <typename Visit>
    void around(const Imath::V3f& position, Visit visit) const {
        const Imath::V3i c = cell(position);
        for (int i = -1; i <= 1; ++i)
            for (int j = -1; j <= 1; ++j)
                for (int k = -1; k <= 1; ++k)
                    if (const auto found = cells_.find(key(c + Imath::V3i(i, j, k))); found != cells_.end())
                        for (const std::uint32_t index : found->second)
                            visit(index);
    }
    bool empty(const Imath::V3f& position) const { return cells_.find(key(cell(position))) == cells_.end(); }

  private:
    Imath::V3i cell(const Imath::V3f& p) const {
        return {int(std::floor(p.x / pitch_)), int(std::floor(p.y / pitch_)), int(std::floor(p.z / pitch_))};
    }
    static std::uint64_t key(const Imath::V3i& c) {
        const auto part = [](int i) { return static_cast<std::uint64_t>(i) & 0x1fffff; };
        return part(c.x) << 42 | part(c.y) << 21 | part(c.z);
    }

    double pitch_;
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

// Heights of cut at nodes a third of the window apart, each from the places within the window that face the same way,
// and smooth between nodes.
class LocalCuts {
  public:
    LocalCuts(const std::vector<Sample>& samples, const AreaPolish& what, Progress& progress)
        : radius_(*what.window), near_(radius_) {
        PointCells all(radius_), taken(radius_ / 3.0);
        for (std::uint32_t i = 0; i < samples.size(); ++i) {
            if (!samples[i].found)
                continue;
            all.add(samples[i].position, i);
            if (taken.empty(samples[i].position)) {
                taken.add(samples[i].position, i);
                near_.add(samples[i].position, static_cast<std::uint32_t>(nodes_.size()));
                nodes_.push_back({samples[i].position, samples[i].normal, {}});
            }
        }
        tbb::parallel_for(std::size_t(0), nodes_.size(), [&](std::size_t n) {
            if (progress.cancelled())
                return;
            Node& node = nodes_[n];
            std::vector<std::uint32_t> chosen;
            all.around(node.position, [&](std::uint32_t i) {
                if ((samples[i].position - node.position).length2() <= radius_ * radius_ &&
                    samples[i].normal.dot(node.normal) > 0.f)
                    chosen.push_back(i);
            });
            std::sort(chosen.begin(), chosen.end());
            node.solution = solve(samples, chosen, what);
        });
        progress.checkpoint();
    }

    double at(const Imath::V3f& position, const Imath::V3f& normal) const {
        double sum = 0.0, weights = 0.0;
        near_.around(position, [&](std::uint32_t n) {
            const Node& node = nodes_[n];
            const double away = (node.position - position).length2() / (radius_ * radius_);
            const double facing = node.normal.dot(normal);
            if (away >= 1.0 || facing <= 0.0 || node.solution.cut == everywhere)
                return;
            const double weight = (1.0 - away) * (1.0 - away) * facing;
            sum += weight * node.solution.cut;
            weights += weight;
        });
        return weights > 0.0 ? sum / weights : everywhere;
    }

    // The means over the nodes.
    Solution mean() const {
        Solution mean{0.0, 0.0};
        double count = 0.0;
        for (const Node& node : nodes_)
            if (node.solution.cut != everywhere) {
                mean.cut += node.solution.cut;
                mean.fraction += node.solution.fraction;
                count += 1.0;
            }
        return count > 0.0 ? Solution{mean.cut / count, mean.fraction / count} : Solution{};
    }

  private:
    struct Node {
        Imath::V3f position, normal;
        Solution solution;
    };
    double radius_;
    PointCells near_;
    std::vector<Node> nodes_;
};

// The height that the cut leaves above each voxel's closest point of the metal, in the binding's order.
std::vector<float> heightsLeft(const Workpiece& work, const ThicknessMap* map, const LocalCuts* local, double cut,
                               Progress& progress) {
    const SurfaceBinding& binding = work.binding;
    const SurfaceMesh& surface = binding.surface();
    const StackProbe probe(work.volume);
    constexpr float untouched = std::numeric_limits<float>::max();
    std::vector<float> heights(binding.leafStart(work.volume.leafCount()), untouched);
    tbb::parallel_for(std::size_t(0), work.volume.leafCount(), [&](std::size_t n) {
        if (progress.cancelled())
            return;
        std::vector<double> thicknessUm(static_cast<std::size_t>(work.volume.layerCount()) + 1);
        ClampedFactors ignored; // counted where the heights were read
        for (std::size_t at = binding.leafStart(n); at < binding.leafStart(n + 1); ++at) {
            const SurfacePoint& under = binding.at(at);
            if (under.triangle < 0)
                continue;
            const double factor = map ? clampedFactor(*map, surface, under, ignored) : 1.0;
            if (factor <= 0.0)
                continue;
            const Imath::V3d position = positionAt(surface, under), normal = normalAt(surface, under);
            const double here = local ? local->at(Imath::V3f(position), Imath::V3f(normal)) : cut;
            if (here == everywhere)
                continue;
            double left = here;
            if (factor < 1.0) {
                const auto reading = probe.read(position, normal, thicknessUm.data());
                if (!reading.found || reading.distance <= here)
                    continue;
                left = heightAfter(reading.distance, factor, here);
            }
            heights[at] = static_cast<float>(left);
        }
    });
    progress.checkpoint();
    return heights;
}

} // namespace

OperationReport polishArea(Workpiece& work, const AreaPolish& what, Progress& progress) {
    OperationReport found;
    const double unitsPerUm = work.volume.scale().unitsPerUm();
    std::size_t count = what.samples;
    if (what.window) {
        // At least some 256 places in a window, as far as memory allows.
        const double windows = work.binding.surface().area() / (3.14159265358979 * *what.window * *what.window);
        count = std::max(count, static_cast<std::size_t>(std::min(256.0 * windows, double(std::size_t(1) << 21))));
    }
    const std::vector<Sample> samples = readSamples(work, what, count, found, progress);
    std::optional<LocalCuts> local;
    Solution solution;
    if (what.window) {
        local.emplace(samples, what, progress);
        solution = local->mean();
    } else {
        std::vector<std::uint32_t> chosen;
        for (std::uint32_t i = 0; i < samples.size(); ++i)
            if (samples[i].found)
                chosen.push_back(i);
        solution = solve(samples, chosen, what);
    }
    OperationReport report;
    if (solution.cut != everywhere) {
        if (!what.map && !local)
            report = polish(work, solution.cut / unitsPerUm, nullptr, progress);
        else
            report = polishTo(work, heightsLeft(work, what.map, local ? &*local : nullptr, solution.cut, progress),
                              progress);
        report.heightUm = solution.cut / unitsPerUm;
    }
    report.fraction = solution.fraction;
    report.clampedBelow = found.clampedBelow;
    report.clampedAbove = found.clampedAbove;
    return report;
}

} // namespace patina
