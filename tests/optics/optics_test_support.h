#pragma once
// What several tests of the optics share: the shipped materials, random stacks, reference reflectances.

#include "base/random.h"
#include "optics/colour.h"
#include "optics/kubelka_munk.h"
#include "optics/layer_stack.h"
#include "optics/material_library.h"
#include "optics/spectrum_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

namespace patina::test {

inline const MaterialLibrary& shippedMaterials() {
    static const MaterialLibrary library = MaterialLibrary::load(std::filesystem::path(PATINA_SOURCE_DIR) / "data");
    return library;
}

/// Measurements that may not be shipped; absent outside the project's workshop.
inline std::filesystem::path sharedData() {
    return std::filesystem::path(PATINA_SOURCE_DIR) / "../shared/data";
}

/// Uniform numbers in a fixed order.
class Uniforms {
  public:
    explicit Uniforms(const char* purpose) : random_(1, "optics test", purpose) {}
    double operator()() {
        if (next_ == 4) {
            four_ = random_.uniforms(event_++, 0, 0, 0);
            next_ = 0;
        }
        return four_[next_++];
    }
    double between(double low, double high) { return low + (high - low) * (*this)(); }
    /// As many below 0.1 as between 1 and 10.
    double logBetween(double low, double high) { return low * std::pow(high / low, (*this)()); }
    int below(int count) { return std::min(static_cast<int>((*this)() * count), count - 1); }

  private:
    KeyedRandom random_;
    std::uint32_t event_ = 0;
    int next_ = 4;
    std::array<double, 4> four_{};
};

/// A metal and 1 … 6 films of the shipped materials, each 0.01 … 100 µm thick.
struct RandomStack {
    std::vector<const Material*> materials;
    std::vector<float> thicknessUm;
};

inline RandomStack randomStack(Uniforms& uniforms) {
    std::vector<const Material*> metals;
    std::vector<const Material*> films;
    for (const std::string& name : shippedMaterials().names()) {
        const Material& material = shippedMaterials().at(name);
        (material.isMetal ? metals : films).push_back(&material);
    }
    RandomStack stack;
    stack.materials.push_back(metals[uniforms.below(static_cast<int>(metals.size()))]);
    const int count = 1 + uniforms.below(6);
    for (int k = 0; k < count; ++k) {
        stack.materials.push_back(films[uniforms.below(static_cast<int>(films.size()))]);
        stack.thicknessUm.push_back(static_cast<float>(uniforms.logBetween(0.01, 100.0)));
    }
    return stack;
}

/// Kubelka–Munk every 5 nm in double precision.
inline FineSpectrum fineBody(const std::vector<const Material*>& materials, const std::vector<float>& thicknessUm) {
    FineSpectrum result = materials[0]->fineReflectance;
    for (std::size_t k = 1; k < materials.size(); ++k) {
        for (int i = 0; i < fineCount; ++i) {
            const auto layer = kubelkaMunkLayer<double>(materials[k]->fineAbsorption[i],
                                                        materials[k]->fineScattering[i], thicknessUm[k - 1]);
            result[i] = overBackground(layer, result[i]);
        }
    }
    return result;
}

/// Everything that light from the normal direction gets back.
inline Imath::V3f total(const Appearance& appearance) {
    Imath::V3f sum = appearance.diffuse;
    for (const Lobe& lobe : appearance.lobes) {
        sum += lobe.colour;
    }
    return sum;
}

inline Imath::V3d labOf(const Imath::V3f& rgb) {
    return labFromXyz(xyzFromLinearRec709(Imath::V3d(rgb)));
}

} // namespace patina::test
