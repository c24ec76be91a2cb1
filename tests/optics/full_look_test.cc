// The whole default look (Kubelka–Munk, interfaces, lobes, air, interference) against docs/optics.md, section 3, worked
// out a second time: every 5 nm, in double precision, with other formulas where there are any.

#include "optics/fresnel.h"
#include "optics/thin_film.h"
#include "optics_test_support.h"

#include <gtest/gtest.h>

#include <complex>

namespace patina {
namespace {

using Imath::V3d;
using Imath::V3f;
using test::shippedMaterials;
using test::Uniforms;

struct Layer {
    const Material* material;
    double um;
    double weight() const { // of its interface
        const double x4 = std::pow(um / StackOptics::interfaceThicknessUm, 4);
        return x4 / (1.0 + x4);
    }
};

struct Part {
    FineSpectrum spectrum{};
};

double interfaceBetween(double a, double b) {
    return std::pow((a - b) / (a + b), 2);
}

/// Everything that comes back at normal incidence, linear Rec.709, each part clipped to the gamut as the model says.
V3d referenceOver(const FineSpectrum& base, const std::vector<Layer>& layers) {
    double index = 1.0;
    std::vector<double> above(layers.size(), 0.0);
    for (std::size_t k = 0; k < layers.size(); ++k) {
        if (k + 1 < layers.size()) {
            above[k] = layers[k].weight() * layers[k + 1].weight() *
                       interfaceBetween(layers[k].material->refractiveIndex, layers[k + 1].material->refractiveIndex);
        }
        index += layers[k].weight() * (layers[k].material->refractiveIndex - index);
    }
    const double k1 = interfaceBetween(index, 1.0), k2 = diffuseInterface(index).internal;
    std::vector<Part> lobes(layers.size() + 1);
    Part diffuse;
    for (int i = 0; i < fineCount; ++i) {
        double r = base[i], glossy = 0.0;
        for (std::size_t k = 0; k < layers.size(); ++k) {
            const Material& m = *layers[k].material;
            r = overBackground(kubelkaMunkLayer<double>(m.fineAbsorption[i], m.fineScattering[i], layers[k].um), r);
            r = above[k] + (1 - above[k]) * (1 - above[k]) * r / (1 - above[k] * r);
        }
        for (std::size_t k = 0; k <= layers.size(); ++k) { // lobe k lies above layer k - 1, 0 is the metal
            double seen = k == 0 ? base[i] : above[k - 1];
            for (std::size_t j = k; j < layers.size(); ++j) {
                const Material& m = *layers[j].material;
                seen *= std::exp(-2.0 * (m.fineAbsorption[i] + m.fineScattering[i]) * layers[j].um);
                seen *= (1 - above[j]) * (1 - above[j]);
            }
            glossy += seen;
            lobes[k].spectrum[i] = (1 - k1) * (1 - k1) * seen;
        }
        // From below: what is scattered, and the k1 of the glossy light that is turned back; k2 of it again and again.
        const double first = std::max(r - glossy, 0.0);
        diffuse.spectrum[i] = (1 - k1) * (1 - k2) * (first + k1 * glossy * r) / (1 - k2 * r);
    }
    V3d sum(0.0);
    const auto add = [&](const Part& part) {
        const V3d rgb = linearRec709(part.spectrum);
        sum += V3d(std::max(rgb.x, 0.0), std::max(rgb.y, 0.0), std::max(rgb.z, 0.0));
    };
    add(diffuse);
    for (const Part& lobe : lobes) {
        add(lobe);
    }
    return V3d(std::min(sum.x, 1 - k1), std::min(sum.y, 1 - k1), std::min(sum.z, 1 - k1)) + V3d(k1);
}

V3d reference(const test::RandomStack& stack, bool thinFilm) {
    std::vector<Layer> layers;
    for (std::size_t k = 0; k < stack.thicknessUm.size(); ++k) {
        const Material* material = stack.materials[k + 1];
        // Neighbours of one material are one layer; two of the shipped mixtures have the same parts.
        const bool same = !layers.empty() && layers.back().material->fineAbsorption == material->fineAbsorption &&
                          layers.back().material->refractiveIndex == material->refractiveIndex &&
                          layers.back().material->roughness == material->roughness;
        if (same) {
            layers.back().um += stack.thicknessUm[k];
        } else {
            layers.push_back({material, stack.thicknessUm[k]});
        }
    }
    const Material& metal = *stack.materials[0];
    const V3d plain = referenceOver(metal.fineReflectance, layers);
    if (!thinFilm || !metal.hasIndex || !layers[0].material->hasIndex) {
        return plain;
    }
    const double share = interferingShare(static_cast<float>(layers[0].um));
    FineSpectrum under{};
    for (int i = 0; i < fineCount; ++i) { // Airy's sum for one film at normal incidence
        const std::complex<double> film(layers[0].material->fineN[i], layers[0].material->fineK[i]);
        const std::complex<double> below(metal.fineN[i], metal.fineK[i]);
        const std::complex<double> r01 = (1.0 - film) / (1.0 + film), r12 = (film - below) / (film + below);
        const std::complex<double> turn = std::exp(
            std::complex<double>(0.0, 4.0 * 3.14159265358979323846 * 1e3 * layers[0].um / fineWavelengthNm(i)) * film);
        under[i] = std::norm((r01 + r12 * turn) / (1.0 + r01 * r12 * turn));
    }
    layers.erase(layers.begin());
    const V3d interfering = referenceOver(under, layers);
    return plain + (interfering - plain) * share;
}

/// Worst ΔE00 of as many random stacks.
double worstDifference(const char* purpose, int count, bool thinFilm, bool thinFirst) {
    Uniforms uniforms(purpose);
    StackFeatures features;
    features.thinFilm = thinFilm;
    double worst = 0.0;
    for (int i = 0; i < count; ++i) {
        test::RandomStack stack = test::randomStack(uniforms);
        if (thinFirst) {
            stack.thicknessUm[0] = static_cast<float>(uniforms.between(0.002, 0.15));
        }
        Appearance look;
        StackOptics(stack.materials, OpticsModel::energyConserving, features).evaluate(stack.thicknessUm.data(), look);
        const V3d fine = labFromXyz(xyzFromLinearRec709(reference(stack, thinFilm)));
        worst = std::max(worst, deltaE2000(test::labOf(test::total(look)), fine));
    }
    return worst;
}

// All shipped materials, 1 … 6 layers of 0.01 … 100 µm on all shipped metals.
TEST(FullLook, bandsAreWithinHalfADeltaEOfFiveNanometres) {
    const double worst = worstDifference("full look", 10000, false, false);
    EXPECT_LE(worst, 0.5);
    RecordProperty("worst_delta_e", std::to_string(worst));
}

TEST(FullLook, interferenceIsWithinHalfADeltaEOfFiveNanometres) {
    const double worst = worstDifference("full look, interference", 5000, true, true);
    EXPECT_LE(worst, 0.5);
    RecordProperty("worst_delta_e", std::to_string(worst));
}

} // namespace
} // namespace patina
