#include "render/stack_blend.h"

#include "base/errors.h"
#include "optics/layer_stack.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

namespace patina {

namespace {

// length[i][j]: of the longest common subsequence of the first i and the first j.
std::vector<std::vector<int>> commonLengths(const std::vector<std::string>& a, const std::vector<std::string>& b) {
    std::vector<std::vector<int>> length(a.size() + 1, std::vector<int>(b.size() + 1, 0));
    for (std::size_t i = 1; i <= a.size(); ++i)
        for (std::size_t j = 1; j <= b.size(); ++j)
            length[i][j] =
                a[i - 1] == b[j - 1] ? length[i - 1][j - 1] + 1 : std::max(length[i - 1][j], length[i][j - 1]);
    return length;
}

// Both sequences merged from the top down: what is common once, the rest where it lies; places of each in the result.
struct Merged {
    std::vector<std::string> layers;
    std::vector<std::size_t> beforePlaces, afterPlaces;
};

Merged merge(const std::vector<std::string>& before, const std::vector<std::string>& after) {
    const auto length = commonLengths(before, after);
    Merged out;
    std::size_t i = before.size(), j = after.size();
    while (i > 0 || j > 0) {
        const std::size_t place = out.layers.size();
        if (i > 0 && j > 0 && before[i - 1] == after[j - 1]) {
            out.layers.push_back(before[--i]);
            --j;
            out.beforePlaces.push_back(place);
            out.afterPlaces.push_back(place);
        } else if (i == 0 || (j > 0 && length[i][j - 1] >= length[i - 1][j])) {
            out.layers.push_back(after[--j]);
            out.afterPlaces.push_back(place);
        } else {
            out.layers.push_back(before[--i]);
            out.beforePlaces.push_back(place);
        }
    }
    std::reverse(out.layers.begin(), out.layers.end());
    for (auto* places : {&out.beforePlaces, &out.afterPlaces}) {
        std::reverse(places->begin(), places->end());
        for (std::size_t& place : *places)
            place = out.layers.size() - 1 - place;
    }
    return out;
}

} // namespace

std::vector<std::string> commonOrder(const std::vector<std::string>& before, const std::vector<std::string>& after) {
    return merge(before, after).layers;
}

StackBlend::StackBlend(const LayerVolume& before, const LayerVolume& after, const SurfaceMesh& surface)
    : surface_(surface), before_(endOf(before)), after_(endOf(after)) {
    if (before.metal() != after.metal())
        throw RunError("pictures between",
                       fmt::format("one moment is of {}, the other of {}", before.metal(), after.metal()));
    if (before.scale().voxelSize != after.scale().voxelSize ||
        before.scale().exaggeration != after.scale().exaggeration)
        throw RunError("pictures between", "the two moments differ in voxel size or exaggeration");
    Merged merged = merge(before.layers(), after.layers());
    if (merged.layers.size() > std::size_t(StackOptics::maxLayers))
        throw RunError("pictures between", fmt::format("the two moments have {} layers together, more than {}",
                                                       merged.layers.size(), StackOptics::maxLayers));
    layers_ = std::move(merged.layers);
    before_.places = std::move(merged.beforePlaces);
    after_.places = std::move(merged.afterPlaces);
}

StackBlend::End StackBlend::endOf(const LayerVolume& volume) const {
    End end{StackProbe(volume), {}, std::vector<float>(surface_.positions.size())};
    tbb::parallel_for(std::size_t(0), end.heights.size(), [&](std::size_t v) {
        std::array<double, StackOptics::maxLayers> thickness;
        end.heights[v] = static_cast<float>(
            end.probe.read(Imath::V3d(surface_.positions[v]), Imath::V3d(surface_.normals[v]), thickness.data())
                .height);
    });
    return end;
}

void StackBlend::thickness(const SurfacePoint& point, float share, float* thicknessUm) const {
    std::fill_n(thicknessUm, layers_.size(), 0.f);
    const Imath::V3d position = positionAt(surface_, point), normal = normalAt(surface_, point);
    std::array<double, StackOptics::maxLayers> read;
    const auto addPart = [&](const End& end, double part) {
        if (part == 0.0)
            return;
        end.probe.read(position, normal, read.data());
        for (std::size_t k = 0; k < end.places.size(); ++k)
            thicknessUm[end.places[k]] += static_cast<float>(part * read[k]);
    };
    addPart(before_, 1.0 - double(share));
    addPart(after_, double(share));
}

std::vector<float> StackBlend::vertexHeights(float share) const {
    std::vector<float> heights(before_.heights.size());
    for (std::size_t v = 0; v < heights.size(); ++v)
        heights[v] = before_.heights[v] * (1.f - share) + after_.heights[v] * share;
    return heights;
}

} // namespace patina
