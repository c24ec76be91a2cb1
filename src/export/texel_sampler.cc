#include "export/texel_sampler.h"

#include "operators/fields/field_grid.h"
#include "volume/nest_grids.h"

#include <algorithm>
#include <cmath>

namespace patina {

using Imath::V3d;

namespace {

// Thinner than a nanometre is not there (docs/architecture.md, material IDs).
constexpr double presentUm = 1e-3;
constexpr int mostAcross = 4;

// From the base to the surface above. Layers thinner than half a voxel go straight up.
V3d vectorOf(const OuterSurface& outer, const StackProbe::Reading& reading, const V3d& position, const V3d& normal,
             double voxelSize) {
    if (!reading.found || reading.projected || reading.height < 0.5 * voxelSize)
        return normal * reading.height;
    const V3d base = position + normal * reading.baseOffset;
    const auto end = outer.above(base);
    return end ? *end - base : normal * reading.height;
}

} // namespace

TexelSampler::TexelSampler(const LayerVolume& volume, const SurfaceWalk& walk, const StackOptics& optics,
                           const BakeOptions& options)
    : volume_(volume), walk_(walk), surface_(walk.surface()), optics_(optics), probe_(volume), outer_(volume),
      voxelSize_(volume.scale().voxelSize),
      slopeScale_(options.keepExaggeration ? 1.0 : 1.0 / volume.scale().exaggeration), layers_(volume.layerCount()),
      resolution_(options.resolution), vectors_(options.vectorDisplacement) {
    if (options.fields)
        for (const auto& field : volume.grids().fields)
            fields_.push_back(makeFieldMap(volume, field.first));
}

int TexelSampler::pointsAcross(int triangle) const {
    const UvDerivatives uv = uvDerivativesOf(surface_, triangle);
    const double width = std::max(uv.du.length(), uv.dv.length()) / (resolution_ * voxelSize_);
    // A hair's breadth is left to rounding, so that texels of one voxel are all read alike.
    return static_cast<int>(std::clamp(std::ceil(width - 1e-3), 1.0, double(mostAcross)));
}

void TexelSampler::readPoint(const SurfacePoint& point, bool askFolds, bool wantSlope, Scratch& scratch,
                             TexelValues& out, Sums& sums) const {
    const V3d position = positionAt(surface_, point), normal = normalAt(surface_, point);
    const auto reading = probe_.read(position, normal, scratch.thickness.data());
    ++out.points;
    out.unreadable += !reading.found;
    int visible = 0;
    for (int k = 0; k < layers_; ++k) {
        scratch.thicknessUm[k] = static_cast<float>(scratch.thickness[k]);
        if (scratch.thickness[k] > presentUm)
            visible = k + 1;
        out.thicknessUm[k] += scratch.thickness[k];
    }
    out.coverage[visible] += 1.0;
    out.height += reading.height;
    const bool crosses = reading.found && !reading.projected;
    if (askFolds) {
        const V3d foot = crosses ? position + normal * reading.baseOffset : position;
        out.folds += outer_.misses(foot, foot + normal * reading.height) ||
                     (crosses && outer_.foldsOver(foot + normal * reading.metalHeight, normal));
    }
    if (crosses) {
        const double offset = reading.baseOffset / voxelSize_;
        out.baseOffset2 += offset * offset;
        out.baseOffset = std::max(out.baseOffset, std::abs(offset));
    }
    if (vectors_)
        out.vector += vectorOf(outer_, reading, position, normal, voxelSize_);
    for (std::size_t f = 0; f < fields_.size(); ++f)
        out.fields[f] += fields_[f]->value({position, normal, point.triangle, point.u, point.v});
    if (wantSlope) {
        const V3d slope = probe_.reliefSlope(position, normal, reading) * slopeScale_;
        sums.slope += slope;
        sums.slope2 += slope.length2();
    }

    const Appearance& look = scratch.look;
    optics_.evaluate(scratch.thicknessUm.data(), scratch.look);
    out.diffuse += V3d(look.diffuse);
    for (int k = 0; k <= layers_; ++k)
        out.lobes[k] += V3d(look.lobes[k].colour);
    out.baseColour += V3d(look.baseColour);
    out.metallic += look.metallic;
    const double alpha = double(look.flattenedRoughness) * look.flattenedRoughness;
    sums.alpha2 += alpha * alpha;
}

template <typename Use>
void TexelSampler::eachPoint(const SurfacePoint& middle, int across, const Use& use) const {
    if (across <= 1)
        return use(middle);
    const UvDerivatives uv = uvDerivativesOf(surface_, middle.triangle);
    for (int j = 0; j < across; ++j)
        for (int i = 0; i < across; ++i) {
            const double x = ((i + 0.5) / across - 0.5) / resolution_, y = ((j + 0.5) / across - 0.5) / resolution_;
            use(walk_.from(middle, uv.du * x + uv.dv * y));
        }
}

double TexelSampler::height(const SurfacePoint& middle, int across, Scratch& scratch) const {
    scratch.thickness.resize(std::max(layers_, 1));
    double sum = 0.0;
    eachPoint(middle, across, [&](const SurfacePoint& point) {
        sum += probe_.read(positionAt(surface_, point), normalAt(surface_, point), scratch.thickness.data()).height;
    });
    return sum / std::max(1, across * across);
}

void TexelSampler::read(const SurfacePoint& middle, int across, bool askFolds, Scratch& scratch,
                        TexelValues& out) const {
    scratch.thickness.resize(std::max(layers_, 1));
    scratch.thicknessUm.resize(std::max(layers_, 1));
    out.points = out.unreadable = out.folds = out.visible = 0;
    out.baseOffset = out.baseOffset2 = 0.0;
    out.height = out.metallic = 0.0;
    out.vector = out.diffuse = out.baseColour = V3d(0.0);
    out.thicknessUm.assign(layers_, 0.0);
    out.coverage.assign(layers_ + 1, 0.0);
    out.fields.assign(fields_.size(), 0.0);
    out.lobes.assign(layers_ + 1, V3d(0.0));
    Sums sums;
    eachPoint(middle, across,
              [&](const SurfacePoint& point) { readPoint(point, askFolds, across > 1, scratch, out, sums); });
    const double share = 1.0 / out.points;
    out.height *= share;
    out.vector *= share;
    for (auto* values : {&out.thicknessUm, &out.coverage, &out.fields})
        for (double& value : *values)
            value *= share;
    out.visible = static_cast<int>(std::max_element(out.coverage.begin(), out.coverage.end()) - out.coverage.begin());
    out.diffuse *= share;
    out.baseColour *= share;
    for (V3d& lobe : out.lobes)
        lobe *= share;
    out.metallic *= share;
    const double hidden = std::max(0.0, sums.slope2 * share - (sums.slope * share).length2());
    out.roughness = std::sqrt(std::sqrt(std::min(1.0, sums.alpha2 * share + hidden)));
}

} // namespace patina
