#include "export/bake_rows.h"

#include "volume/nest_grids.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina {

using Imath::V3d;
using Imath::V3f;

BakeRows::BakeRows(const LayerVolume& volume, const StackOptics& optics, const BakeOptions& options, int rows)
    : size_(options.resolution), rows_(rows), layers_(volume.layerCount()),
      displacementScale_(options.displacementUnits *
                         (options.keepExaggeration ? 1.0 : 1.0 / volume.scale().exaggeration)) {
    ids_.push_back(1.f);
    for (const std::string& layer : volume.layers())
        ids_.push_back(static_cast<float>(volume.findMaterialId(layer)));
    const auto layerName = [&](int k) {
        return fmt::format("{:02d}_{}", k, k == 0 ? volume.metal() : volume.layers()[k - 1]);
    };
    const std::size_t texels = static_cast<std::size_t>(size_) * rows_;
    height_.assign(texels, 0.f);
    fold_.assign(texels, 0.f);
    visible_.assign(texels, unset);

    displacement_ = add("displacement", 1, false, false);
    infos_[displacement_].numbers.emplace_back("patina_max_displacement", 0.f);
    infos_[displacement_].texts.emplace_back("patina_units", "scene units along the normal, zero at the bare metal");
    diffuse_ = add("diffuse", 3, true, true);
    Appearance bare;
    optics.evaluate(std::vector<float>(std::max(layers_, 1), 0.f).data(), bare);
    for (int k = 0; k <= layers_; ++k) {
        const int map = add("lobe_" + layerName(k), 3, true, true);
        if (k == 0)
            lobes_ = map;
        infos_[map].numbers.emplace_back("patina_ggx_alpha", bare.lobes[k].alpha);
        infos_[map].numbers.emplace_back("patina_roughness", bare.lobes[k].roughness);
    }
    baseColour_ = add("base_color", 3, true, true);
    metallic_ = add("metallic", 1, false, true);
    roughness_ = add("roughness", 1, false, true);
    normal_ = add("normal", 3, false, true);
    thickness_ = static_cast<int>(infos_.size());
    for (int k = 1; k <= layers_; ++k) {
        const int map = add("thickness_" + layerName(k), 1, false, false);
        infos_[map].texts.emplace_back("patina_units", "real micrometres of solid");
        add("coverage_" + layerName(k), 1, false, true);
    }
    if (options.materialId)
        materialId_ = add("material_id", 1, false, false);
    if (options.foldMask) {
        foldMask_ = add("fold_mask", 1, false, true);
        infos_[foldMask_].numbers.emplace_back("patina_fold_fraction", 0.f);
    }
    if (options.vectorDisplacement) {
        vectors_ = add("vector_displacement", 3, false, false);
        infos_[vectors_].texts.emplace_back("patina_units", "scene units, from the bare metal");
        infos_[vectors_].texts.emplace_back("patina_space", nameOf(options.vectorSpace));
    }
    if (options.fields) {
        fields_ = static_cast<int>(infos_.size());
        for (const auto& field : volume.grids().fields) {
            add("field_" + field.first, 1, false, true);
            ++fieldCount_;
        }
    }
    for (MapInfo& info : infos_)
        info.colourSpace = optics.features().colourSpace;
}

int BakeRows::add(const std::string& name, int channels, bool isColour, bool isHalf) {
    MapInfo info;
    info.name = name;
    info.size = size_;
    info.channels = channels;
    info.isColour = isColour;
    info.isHalf = isHalf;
    infos_.push_back(info);
    const std::size_t count = static_cast<std::size_t>(size_) * rows_ * channels;
    floats_.emplace_back(isHalf ? 0 : count, 0.f);
    halves_.emplace_back(isHalf ? count : 0, Imath::half(0.f));
    return static_cast<int>(infos_.size()) - 1;
}

void BakeRows::set(int map, std::size_t texel, double value) {
    if (halves_[map].empty())
        floats_[map][texel] = static_cast<float>(value);
    else
        halves_[map][texel] = Imath::half(static_cast<float>(value));
}

void BakeRows::set(int map, std::size_t texel, const V3d& value) {
    if (halves_[map].empty()) {
        float* pixel = floats_[map].data() + texel * 3;
        for (int c = 0; c < 3; ++c)
            pixel[c] = static_cast<float>(value[c]);
        return;
    }
    Imath::half* pixel = halves_[map].data() + texel * 3;
    for (int c = 0; c < 3; ++c)
        pixel[c] = Imath::half(static_cast<float>(value[c]));
}

void BakeRows::clearRow(int y) {
    const std::size_t first = at(y, 0);
    std::fill_n(height_.begin() + first, size_, 0.f);
    std::fill_n(visible_.begin() + first, size_, unset);
    for (std::size_t m = 0; m < infos_.size(); ++m) {
        const int channels = infos_[m].channels;
        if (infos_[m].isHalf)
            std::fill_n(halves_[m].begin() + first * channels, size_ * channels, Imath::half(0.f));
        else
            std::fill_n(floats_[m].begin() + first * channels, size_ * channels, 0.f);
    }
}

void BakeRows::put(int y, int x, const TexelValues& values) {
    visible_[at(y, x)] = static_cast<std::uint8_t>(values.visible);
    fold_[at(y, x)] = static_cast<float>(values.folds) / static_cast<float>(values.points);
    replace(y, x, values);
}

void BakeRows::replace(int y, int x, const TexelValues& values) {
    const std::size_t texel = at(y, x);
    putHeight(y, x, values.height);
    set(diffuse_, texel, values.diffuse);
    for (int k = 0; k <= layers_; ++k)
        set(lobes_ + k, texel, values.lobes[k]);
    set(baseColour_, texel, values.baseColour);
    set(metallic_, texel, values.metallic);
    set(roughness_, texel, values.roughness);
    for (int k = 0; k < layers_; ++k) {
        set(thickness_ + 2 * k, texel, values.thicknessUm[k]);
        set(thickness_ + 2 * k + 1, texel, values.coverage[k + 1]);
    }
    if (materialId_ >= 0)
        set(materialId_, texel, ids_[values.visible]);
    if (foldMask_ >= 0)
        putFold(y, x, static_cast<float>(values.folds) / static_cast<float>(values.points));
    if (vectors_ >= 0)
        set(vectors_, texel, values.vector * displacementScale_);
    for (int f = 0; f < fieldCount_; ++f)
        set(fields_ + f, texel, values.fields[f]);
}

void BakeRows::putFold(int y, int x, float share) {
    fold_[at(y, x)] = share;
    if (foldMask_ >= 0)
        set(foldMask_, at(y, x), share);
}

void BakeRows::putHeight(int y, int x, double height) {
    height_[at(y, x)] = static_cast<float>(height * displacementScale_);
    set(displacement_, at(y, x), height_[at(y, x)]);
}

void BakeRows::putNormal(int y, int x, const V3f& encoded) { set(normal_, at(y, x), V3d(encoded)); }

void BakeRows::copyTexel(int toY, int toX, int fromY, int fromX) {
    const std::size_t to = at(toY, toX), from = at(fromY, fromX);
    for (std::size_t m = 0; m < halves_.size(); ++m) {
        const auto copy = [&](auto& pixels) {
            const auto channels = static_cast<std::size_t>(infos_[m].channels);
            std::copy_n(pixels.begin() + from * channels, channels, pixels.begin() + to * channels);
        };
        halves_[m].empty() ? copy(floats_[m]) : copy(halves_[m]);
    }
}

const void* BakeRows::row(int map, int y) const {
    const std::size_t first = at(y, 0) * infos_[map].channels;
    return infos_[map].isHalf ? static_cast<const void*>(halves_[map].data() + first) : floats_[map].data() + first;
}

std::vector<std::vector<std::pair<std::string, float>>> BakeRows::finalNumbers(const BakeSummary& summary) const {
    std::vector<std::vector<std::pair<std::string, float>>> numbers(infos_.size());
    numbers[displacement_].emplace_back("patina_max_displacement", summary.maxDisplacement);
    if (foldMask_ >= 0)
        numbers[foldMask_].emplace_back("patina_fold_fraction", static_cast<float>(summary.foldFraction));
    return numbers;
}

} // namespace patina
