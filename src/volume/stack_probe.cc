#include "volume/stack_probe.h"

#include "volume/nest_sampler.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>
#include <vector>

namespace patina {

namespace {

// Whether a layer has grown in voxels with pores, which have a value of their own: half a voxel, exactly.
bool hasPores(const LayerVolume& volume) {
    const auto pore = static_cast<float>(0.5 * volume.scale().voxelSize);
    std::atomic<bool> found{false};
    for (const auto& interface : volume.grids().interfaces) {
        const auto leaves = leavesOf(std::as_const(interface->tree()));
        tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
            if (found.load(std::memory_order_relaxed))
                return;
            const float* values = leaves[n]->buffer().data();
            int pores = 0;
            for (int i = 0; i < 512; ++i)
                pores += values[i] == pore;
            if (pores > 2) // a voxel here and there may have the value by chance, and no harm done
                found.store(true, std::memory_order_relaxed);
        });
    }
    return found;
}

} // namespace

struct StackProbe::Nest {
    NestSampler sampler;
    VolumeScale scale;
    int layers;
    double reach; ///< voxels outside the base where a surface may be
    double depth; ///< voxels inside the base where eroded metal may end
    bool porous;  ///< whether a line may cross an interface more than once

    // A line that is read at one place after another, most of them in the same cell.
    struct Line {
        Imath::V3d origin, direction;
        NestPlace place{};

        Imath::V3d at(double s) const { return origin + direction * s; }
    };

    // phi_k along the line, in voxels (phi / voxelSize), and its slope.
    double along(int k, Line& line, double s, double& slope) const {
        Imath::V3d gradient;
        const double phi = sampler.valueAndGradient(k, sampler.follow(line.at(s), line.place), gradient);
        slope = gradient.dot(line.direction) / scale.voxelSize;
        return phi / scale.voxelSize;
    }

    // How far from the base a crossing s along the line is. Within a voxel phi_0 itself says it, a true distance
    // whatever its trilinear slope beside an edge, and whatever the angle between the line and the voxels' normal; from
    // two voxels on it is the way along the line, which a crease's other side does not shorten.
    double distanceFromBase(Line& line, double base, double s) const {
        const double along = s - base, share = std::clamp(2.0 - std::abs(along), 0.0, 1.0);
        if (share == 0.0)
            return along;
        const double near = std::clamp(along, -1.0, 1.0);
        const NestCell& cell = sampler.follow(line.at(base + near), line.place);
        const double away = sampler.value(sampler.reference(), cell) / scale.voxelSize;
        return along + share * (away - near);
    }

    // The first outward crossing of phi_k in [from, to], phi_k(from) <= 0 assumed; `to` where there is none. A line
    // that meets the metal again before it is out of the layer (a crease filled to the brim) crosses there. Newton with
    // a bracket: along a line the trilinear field is a cubic within each cell and kinked between cells.
    double crossing(int k, Line& line, double from, double to) const {
        double slope = 0.0;
        double low = from;
        double f = along(k, line, from, slope);
        if (f >= 0.0)
            return from;
        double high = to;
        bool bracketed = false;
        double s = from;
        for (int iteration = 0; iteration < 60; ++iteration) {
            double next = slope > 0.05 ? s - f / slope : s + 0.5;
            if (bracketed) {
                if (!(next > low && next < high))
                    next = 0.5 * (low + high);
            } else {
                // Outward in steps of at most half a voxel, so that no crossing is stepped over.
                next = std::min({next, s + 0.5, to});
            }
            // A step of Newton's this short ends nearer to the crossing than its square.
            if (std::abs(next - s) <= 1e-8)
                return next;
            const double before = s;
            s = next;
            f = along(k, line, s, slope);
            if (k > 0 && !bracketed && f < 0.0) {
                double ignored;
                if (along(0, line, s, ignored) < 0.0) {
                    // In metal again: was there air on the way, in a gap narrower than the step?
                    const double step = s - before;
                    for (int i = 1; i < 8 && f < 0.0; ++i) {
                        s = before + step * i / 8.0;
                        f = along(k, line, s, slope);
                    }
                    if (f < 0.0)
                        return metalBetween(line, before, before + step);
                }
            }
            if (f == 0.0)
                return s;
            if (f > 0.0) {
                high = s;
                bracketed = true;
            } else {
                low = s;
                if (!bracketed && s >= to)
                    return to;
            }
            if (bracketed && high - low < 1e-13)
                return s;
        }
        return s;
    }

    // Where phi_0 falls below 0 between `outside` and `inside`.
    double metalBetween(Line& line, double outside, double inside) const {
        double slope;
        for (int i = 0; i < 40; ++i) {
            const double middle = 0.5 * (outside + inside);
            (along(0, line, middle, slope) < 0.0 ? inside : outside) = middle;
        }
        return outside;
    }

    // Of layers with pores and overhangs: how much of the line from `floor` outward lies within each layer, voxels, and
    // where it leaves the outermost one for good. The line ends where it comes nearer to another part of the model.
    double solidLengths(Line& line, double floor, double end, double* lengths) const {
        const auto count = static_cast<std::size_t>(layers) + 1;
        std::vector<double> before(count), now(count), inside(count, 0.0);
        const auto read = [&](double s, std::vector<double>& phi) {
            const NestCell& cell = sampler.follow(line.at(s), line.place);
            for (std::size_t k = 0; k < count; ++k)
                phi[k] = sampler.value(static_cast<int>(k), cell) / scale.voxelSize;
            return sampler.value(sampler.reference(), cell) / scale.voxelSize;
        };
        double s = floor, outermost = floor;
        double away = read(s, before);
        while (s < end) {
            double step = std::abs(before[1]);
            for (const double phi : before)
                step = std::min(step, std::abs(phi));
            step = std::clamp(0.9 * step, 0.125, 2.0);
            const double awayNow = read(s + step, now);
            // A line that grazes a wall opposite is no part of this place's stack; nor is metal further out.
            if (s - floor > 1.0 && (awayNow - away < 0.05 * step || now[0] < 0.0))
                break;
            for (std::size_t k = 1; k < count; ++k) {
                const double f = before[k], g = now[k];
                const double crossing = f == g ? 0.5 : f / (f - g);
                if (f <= 0.0)
                    inside[k] += g <= 0.0 ? step : crossing * step;
                else if (g <= 0.0)
                    inside[k] += (1.0 - crossing) * step;
                if (k + 1 == count && (f <= 0.0 || g <= 0.0))
                    outermost = g <= 0.0 ? s + step : s + crossing * step;
            }
            s += step;
            away = awayNow;
            before.swap(now);
        }
        for (std::size_t k = 1; k < count; ++k)
            lengths[k - 1] = std::max(0.0, inside[k] - inside[k - 1]);
        return outermost;
    }

    // The crossing of phi_0 that Newton steps down its gradient lead to, if they do within 3 voxels.
    bool project(Imath::V3d& point, Imath::V3d& normal) const {
        const Imath::V3d start = point;
        for (int i = 0; i < 12; ++i) {
            Imath::V3d gradient;
            const double phi =
                sampler.valueAndGradient(sampler.reference(), sampler.locate(point), gradient) / scale.voxelSize;
            gradient /= scale.voxelSize;
            const double squared = gradient.length2();
            if (squared < 1e-3 || (point - start).length2() > 9.0)
                return false;
            if (std::abs(phi) < 1e-3) {
                normal = gradient / std::sqrt(squared);
                return true;
            }
            const double step = std::clamp(-phi / std::sqrt(squared), -0.7, 0.7);
            point += gradient * (step / std::sqrt(squared));
        }
        return false;
    }

    // Whether the line leaves the base at a grazing angle. A stack read along it would be thicker by 1 / cos: more than
    // three times where the model's smooth normal and the voxels disagree so much (a sharp crease, a thin edge).
    bool grazes(Line& line, double s) const {
        Imath::V3d gradient;
        sampler.valueAndGradient(sampler.reference(), sampler.follow(line.at(s), line.place), gradient);
        return gradient.dot(line.direction) < 0.3 * gradient.length();
    }

    // Where the base crosses the line within 2 voxels of its origin; a value of 2 or more where it does not.
    double baseCrossing(Line& line) const {
        // Inward until inside (the base lies within the voxelisation error of the point), then outward to the crossing.
        const int base = sampler.reference();
        double slope = 0.0;
        double start = 0.0;
        double f = along(base, line, start, slope);
        while (f > 0.0 && start > -2.0) {
            start -= std::clamp(f * 1.5, 0.02, 0.5);
            f = along(base, line, start, slope);
        }
        return f > 0.0 ? 2.0 : crossing(base, line, start, 2.0);
    }

    // Where what is left of the metal crosses the line, at or below the base's crossing. Where the metal is eaten
    // through, as deep as the line comes: half way to the other side, or the band's inner edge.
    double floorCrossing(Line& line, double base) const {
        if (sampler.reference() == 0)
            return base;
        double slope = 0.0;
        double s = base;
        double f = along(0, line, s, slope);
        double deepest = along(sampler.reference(), line, s, slope);
        // Where the line grazes a wall, as it does under the edge of a sheet, steps by the distance would be endless.
        constexpr double touches = 1e-6, leastStep = 0.05;
        while (f > touches && s > base - depth) {
            const double next = s - std::clamp(f, leastStep, 0.5);
            const double original = along(sampler.reference(), line, next, slope);
            if (original > deepest + 1e-6)
                return s;
            deepest = original;
            s = next;
            f = along(0, line, s, slope);
        }
        return f > 0.0 ? s : std::min(base, crossing(0, line, s, base));
    }
};

StackProbe::StackProbe(const LayerVolume& volume)
    : nest_(new Nest{NestSampler(volume.grids()), volume.scale(), volume.layerCount(),
                     volume.grids().exteriorBand + 2.0, volume.grids().interiorBand + 1.0, hasPores(volume)}) {}
StackProbe::~StackProbe() = default;
StackProbe::StackProbe(StackProbe&&) noexcept = default;

int StackProbe::layerCount() const {
    return nest_->layers;
}

Imath::V3d StackProbe::reliefSlope(const Imath::V3d& point, const Imath::V3d& normal, const Reading& reading) const {
    if (!reading.found || reading.projected)
        return Imath::V3d(0.0);
    const Nest& nest = *nest_;
    const auto slopeOf = [&](int k, double offset) {
        Imath::V3d gradient;
        nest.sampler.valueAndGradient(k, nest.sampler.locate((point + normal * offset) / nest.scale.voxelSize),
                                      gradient);
        const double along = gradient.dot(normal);
        // Steeper than 1 in 0.05 is a wall, which no height has.
        return (normal * along - gradient) / std::max(along, 0.05 * gradient.length() + 1e-300);
    };
    return slopeOf(nest.layers, reading.baseOffset + reading.height) -
           slopeOf(nest.sampler.reference(), reading.baseOffset);
}

StackProbe::Reading StackProbe::read(const Imath::V3d& point, const Imath::V3d& normal, double* thicknessUm) const {
    const Nest& nest = *nest_;
    const VolumeScale& scale = nest.scale;
    Nest::Line line{point / scale.voxelSize, normal};
    Reading reading;
    std::fill(thicknessUm, thicknessUm + nest.layers, 0.0);

    double below = nest.baseCrossing(line);
    if (below >= 2.0 || nest.grazes(line, below)) {
        if (below < 2.0)
            line.origin = line.at(below);
        if (!nest.project(line.origin, line.direction))
            return reading;
        below = nest.baseCrossing(line);
        if (below >= 2.0)
            return reading;
        reading.projected = true;
    }
    reading.found = true;
    reading.baseOffset = below * scale.voxelSize;
    const double base = below;
    const double umPerVoxel = 1.0 / scale.voxelsPerUm();
    below = nest.floorCrossing(line, base);
    reading.metalHeight = (below - base) * scale.voxelSize;
    if (nest.porous) {
        below = nest.solidLengths(line, below, base + nest.reach, thicknessUm);
        for (int k = 0; k < nest.layers; ++k)
            thicknessUm[k] *= umPerVoxel;
        reading.height = reading.distance = (below - base) * scale.voxelSize;
        reading.metalDistance = reading.metalHeight;
        return reading;
    }
    double distance = nest.distanceFromBase(line, base, below);
    reading.metalDistance = distance * scale.voxelSize;
    for (int k = 1; k <= nest.layers; ++k) {
        const double crossing = std::max(below, nest.crossing(k, line, below, base + nest.reach));
        if (crossing > below) {
            const double next = nest.distanceFromBase(line, base, crossing);
            thicknessUm[k - 1] = std::max(0.0, next - distance) * umPerVoxel;
            distance = std::max(distance, next);
        }
        below = crossing;
    }
    reading.height = (below - base) * scale.voxelSize;
    reading.distance = distance * scale.voxelSize;
    return reading;
}

} // namespace patina
