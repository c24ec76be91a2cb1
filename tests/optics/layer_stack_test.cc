// Vectors of the baseline's width only: what the note says of wider ones does not matter here.
#pragma GCC diagnostic ignored "-Wpsabi"

#include "base/errors.h"
#include "optics/band_lanes.h"
#include "optics/layer_stack.h"
#include "optics/stack_kernel.h"
#include "optics_test_support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace patina {
namespace {

using Imath::V3d;
using Imath::V3f;
using test::shippedMaterials;
using test::Uniforms;

Appearance look(const std::vector<std::string>& names, const std::vector<float>& thicknessUm,
                OpticsModel model = OpticsModel::energyConserving) {
    std::vector<const Material*> materials;
    for (const std::string& name : names) {
        materials.push_back(&shippedMaterials().at(name));
    }
    Appearance appearance;
    StackOptics(materials, model).evaluate(thicknessUm.data(), appearance);
    return appearance;
}

void expectNear(const V3f& a, const V3f& b, float tolerance) {
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(a[c], b[c], tolerance);
    }
}

TEST(LayerStack, bareMetalIsAPureMirror) {
    const Appearance bare = look({"copper"}, {});
    expectNear(bare.diffuse, V3f(0.f), 0.f);
    ASSERT_EQ(bare.lobes.size(), 1u);
    expectNear(bare.lobes[0].colour, shippedMaterials().at("copper").specularColour, 2e-3f);
    expectNear(bare.lobes[0].edgeColour, V3f(1.f), 1e-6f);
    EXPECT_EQ(bare.metallic, 1.f);
}

TEST(LayerStack, thinTarnishDimsTheMirrorAndThickPatinaIsMatte) {
    const float bare = look({"copper"}, {}).lobes[0].colour.x;
    const float thin = look({"copper", "tarnish_1"}, {0.05f}).lobes[0].colour.x;
    EXPECT_LT(thin, 0.8f * bare);
    EXPECT_GT(thin, 0.4f * bare);
    const Appearance thick = look({"copper", "tarnish_1", "cuprite_2", "marine_patina_4"}, {0.35f, 1.2f, 5.f});
    EXPECT_LT(thick.lobes[0].colour.x, 1e-4f);
    EXPECT_GT(thick.diffuse.y, 0.2f);
    EXPECT_LT(thick.metallic, 0.01f);
    float glossy = 0.f;
    for (const Lobe& lobe : thick.lobes) {
        glossy += lobe.colour.y;
    }
    EXPECT_LT(glossy, 0.04f);
}

TEST(LayerStack, aLayerOfNoThicknessIsNotThere) {
    const Appearance with = look({"copper", "cuprite_2", "dirt", "marine_patina_4"}, {0.7f, 0.f, 2.f});
    const Appearance without = look({"copper", "cuprite_2", "marine_patina_4"}, {0.7f, 2.f});
    EXPECT_EQ(with.diffuse, without.diffuse);
    EXPECT_EQ(with.lobes[0].colour, without.lobes[0].colour);
    EXPECT_EQ(with.lobes[1].colour, without.lobes[1].colour);
    EXPECT_EQ(with.lobes[2].colour, V3f(0.f));
    EXPECT_EQ(with.lobes[3].colour, without.lobes[2].colour);
}

TEST(LayerStack, colourIsContinuousWhereALayerEnds) {
    for (const char* top : {"cuprite", "antlerite", "lacquer", "soot"}) {
        V3f last = test::total(look({"copper", "cuprite_2", top}, {0.3f, 0.f}));
        const Appearance before = look({"copper", "cuprite_2", top}, {0.3f, 0.f});
        const Appearance after = look({"copper", "cuprite_2", top}, {0.3f, 1e-4f});
        expectNear(before.diffuse, after.diffuse, 3e-3f);
        for (std::size_t i = 0; i < before.lobes.size(); ++i) {
            expectNear(before.lobes[i].colour, after.lobes[i].colour, 3e-3f);
            expectNear(before.lobes[i].edgeColour, after.lobes[i].edgeColour, 3e-3f);
        }
        for (int step = 0; step <= 400; ++step) {
            const V3f now = test::total(look({"copper", "cuprite_2", top}, {0.3f, 0.001f * step}));
            expectNear(now, last, 0.02f);
            last = now;
        }
    }
}

TEST(LayerStack, bandKernelIsKubelkaMunk) {
    Uniforms uniforms("kernel");
    for (int i = 0; i < 2000; ++i) {
        const test::RandomStack stack = test::randomStack(uniforms);
        const Spectrum body = StackOptics(stack.materials).bodyReflectance(stack.thicknessUm.data());
        for (int band = 0; band < bandCount; ++band) {
            double expected = stack.materials[0]->reflectance[band];
            for (std::size_t k = 1; k < stack.materials.size(); ++k) {
                const Material& m = *stack.materials[k];
                expected = overBackground(
                    kubelkaMunkLayer<double>(m.absorption[band], m.scattering[band], stack.thicknessUm[k - 1]),
                    expected);
            }
            ASSERT_NEAR(body[band], expected, 2e-5);
        }
    }
}

/// The look without which piece of a layer a lobe belongs to.
void expectSameLook(const Appearance& a, const Appearance& b, const std::string& what) {
    SCOPED_TRACE(what);
    EXPECT_EQ(a.diffuse, b.diffuse);
    EXPECT_EQ(a.baseColour, b.baseColour);
    EXPECT_EQ(a.metallic, b.metallic);
    EXPECT_EQ(a.flattenedRoughness, b.flattenedRoughness);
    EXPECT_EQ(a.specular, b.specular);
    const auto lit = [](const Appearance& look) {
        std::vector<Lobe> lobes;
        for (const Lobe& lobe : look.lobes) {
            if (lobe.edgeColour != V3f(0.f)) {
                lobes.push_back(lobe);
            }
        }
        return lobes;
    };
    const std::vector<Lobe> left = lit(a), right = lit(b);
    ASSERT_EQ(left.size(), right.size());
    for (std::size_t i = 0; i < left.size(); ++i) {
        EXPECT_EQ(left[i].colour, right[i].colour);
        EXPECT_EQ(left[i].edgeColour, right[i].edgeColour);
        EXPECT_EQ(left[i].air, right[i].air);
        EXPECT_EQ(left[i].airEdge, right[i].airEdge);
        EXPECT_EQ(left[i].alpha, right[i].alpha);
    }
}

// Where a layer is cut must not be seen: not by Kubelka–Munk, not by the surface that a film has from a quarter wave
// on, not by interference. Halves add up exactly in floating point, so the look is the same to the bit.
TEST(LayerStack, splittingALayerInTwoChangesNothing) {
    const auto& library = shippedMaterials();
    const Material* copper = &library.at("copper");
    for (const char* name : {"cuprite", "rural_patina_4", "lacquer", "tenorite", "soot"}) {
        for (const float um : {0.02f, 0.06f, 0.12f, 0.2f, 0.5f, 4.f}) {
            for (const bool thinFilm : {false, true}) {
                for (const OpticsModel model : {OpticsModel::energyConserving, OpticsModel::paper}) {
                    StackFeatures features;
                    features.thinFilm = thinFilm;
                    const Material* film = &library.at(name);
                    const Material* green = &library.at("brochantite");
                    const float whole[] = {um, 1.f}, halves[] = {0.5f * um, 0.5f * um, 1.f};
                    const float spread[] = {0.25f * um, 0.f, 0.75f * um, 1.f};
                    Appearance one, two, three;
                    StackOptics({copper, film, green}, model, features).evaluate(whole, one);
                    StackOptics({copper, film, film, green}, model, features).evaluate(halves, two);
                    // A copy, as two entries of a library may be, and an absent layer of another material between.
                    const Material copy = *film;
                    StackOptics({copper, film, green, &copy, green}, model, features).evaluate(spread, three);
                    const std::string what = std::string(name) + " " + std::to_string(um);
                    expectSameLook(one, two, what);
                    expectSameLook(one, three, what);
                }
            }
        }
    }
}

TEST(LayerStack, splittingALayerInTwoKeepsTheBody) {
    const auto& library = shippedMaterials();
    const Material* copper = &library.at("copper");
    const Material* patina = &library.at("rural_patina_4");
    // The same constants in a material that differs in its surface are two layers to the kernel.
    Material other = *patina;
    other.roughness = 0.9f;
    const float whole[] = {2.5f};
    const float parts[] = {0.9f, 1.6f};
    const Spectrum a = StackOptics({copper, patina}).bodyReflectance(whole);
    const Spectrum b = StackOptics({copper, patina, &other}).bodyReflectance(parts);
    for (int band = 0; band < bandCount; ++band) {
        EXPECT_NEAR(a[band], b[band], 2e-6);
    }
}

// A million stacks of one to six layers through the loop that ships: K, S and d over nine decades, none of the three
// in one case of twenty, no end to d in one of twenty, a base that may be black or white. Against double precision.
TEST(LayerStack, bandKernelHoldsForAMillionRandomStacks) {
    Uniforms uniforms("million kernels");
    const auto pick = [&](double low, double high) {
        const double u = uniforms();
        return static_cast<float>(u < 0.05 ? 0.0 : low * std::pow(high / low, (u - 0.05) / 0.95));
    };
    constexpr int spectra = 1000000 / bandCount;
    double worst = 0.0;
    for (int i = 0; i < spectra; ++i) {
        const int count = 1 + uniforms.below(6);
        std::vector<Material> materials(count + 1);
        std::vector<const Material*> pointers(count + 1);
        std::vector<float> um(count);
        materials[0].isMetal = true;
        for (int band = 0; band < bandCount; ++band) {
            const double u = uniforms();
            materials[0].reflectance[band] = u < 0.1 ? 0.f : u > 0.9 ? 1.f : static_cast<float>(u);
        }
        for (int k = 1; k <= count; ++k) {
            for (int band = 0; band < bandCount; ++band) {
                materials[k].absorption[band] = pick(1e-6, 1e3);
                materials[k].scattering[band] = pick(1e-6, 1e3);
            }
            um[k - 1] = uniforms() < 0.05 ? std::numeric_limits<float>::infinity() : pick(1e-5, 1e4);
            materials[k].refractiveIndex = static_cast<float>(uniforms.between(1.0, 3.0));
        }
        for (int k = 0; k <= count; ++k) {
            pointers[k] = &materials[k];
        }
        const StackOptics optics(pointers);
        const Spectrum body = optics.bodyReflectance(um.data());
        for (int band = 0; band < bandCount; ++band) {
            double expected = materials[0].reflectance[band];
            for (int k = 1; k <= count; ++k) {
                // The kernel takes a layer without end for one of a metre.
                const double d = std::min(um[k - 1], 1e6f);
                expected = overBackground(
                    kubelkaMunkLayer<double>(materials[k].absorption[band], materials[k].scattering[band], d),
                    expected);
            }
            ASSERT_TRUE(body[band] >= 0.f && body[band] <= 1.f + 1e-6f) << body[band];
            worst = std::max(worst, std::abs(body[band] - expected));
            ASSERT_NEAR(body[band], expected, 2e-6) << i << " band " << band;
        }
        if (i % 16 == 0) { // the whole look costs more: every sixteenth
            Appearance look;
            optics.evaluate(um.data(), look);
            const V3f sum = test::total(look);
            for (int c = 0; c < 3; ++c) {
                ASSERT_TRUE(look.diffuse[c] >= 0.f && sum[c] <= 1.f + 2e-6f) << sum[c];
            }
        }
    }
    RecordProperty("worst_error_1e9", std::to_string(worst * 1e9));
}

TEST(LayerStack, neverReflectsMoreThanItReceives) {
    Uniforms uniforms("energy");
    Appearance out;
    for (int i = 0; i < 20000; ++i) {
        const test::RandomStack stack = test::randomStack(uniforms);
        StackOptics(stack.materials).evaluate(stack.thicknessUm.data(), out);
        const V3f sum = test::total(out);
        for (int c = 0; c < 3; ++c) {
            ASSERT_LE(sum[c], 1.f + 2e-6f);
            ASSERT_GE(out.diffuse[c], 0.f);
            for (const Lobe& lobe : out.lobes) {
                ASSERT_GE(lobe.colour[c], 0.f);
                ASSERT_LE(lobe.edgeColour[c] - lobe.airEdge, 1.f + 1e-6f);
                ASSERT_LE(lobe.airEdge, 1.f);
            }
            ASSERT_LE(out.baseColour[c], 1.f);
        }
        ASSERT_TRUE(out.metallic >= 0.f && out.metallic <= 1.f);
        ASSERT_TRUE(out.flattenedRoughness >= 0.f && out.flattenedRoughness <= 1.f);
    }
}

TEST(LayerStack, survivesStrangeThicknesses) {
    const float infinity = std::numeric_limits<float>::infinity();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (float strange : {infinity, nan, -1.f, 0.f, 1e-30f, 1e30f}) {
        for (OpticsModel model : {OpticsModel::energyConserving, OpticsModel::paper}) {
            for (const char* film : {"lacquer", "soot", "marine_patina_3"}) {
                const Appearance appearance = look({"copper", film, "cuprite"}, {strange, strange}, model);
                const V3f sum = test::total(appearance);
                for (int c = 0; c < 3; ++c) {
                    EXPECT_TRUE(sum[c] >= 0.f && sum[c] <= 2.f) << film << " " << strange;
                }
            }
        }
    }
}

// TRUTHS: a smooth interface of index 1.5 over a Lambertian base of 0.5, light from the normal.
TEST(LayerStack, interfaceOverALambertianBaseIsSaundersonsSum) {
    Material base = shippedMaterials().at("copper");
    Material film;
    film.scattering = Spectrum::constant(1.f);
    film.absorption = Spectrum::constant(0.25f); // K/S of R = 0.5
    film.refractiveIndex = 1.5f;
    film.roughness = 0.001f;
    Appearance out;
    const float opaque[] = {1e4f};
    StackOptics({&base, &film}).evaluate(opaque, out);
    expectNear(test::total(out), V3f(0.31607f), 1e-4f);
    expectNear(out.diffuse, V3f(0.27607f), 1e-4f);
    film.refractiveIndex = 2.f;
    StackOptics({&base, &film}).evaluate(opaque, out);
    expectNear(test::total(out), V3f(0.26529f), 2e-4f);
}

TEST(LayerStack, paperModelIsThePapersSum) {
    const auto& library = shippedMaterials();
    const Material& copper = library.at("copper");
    const Material& film = library.at("marine_patina_4");
    const float d = 1.5f;
    const Appearance out = look({"copper", "marine_patina_4"}, {d}, OpticsModel::paper);
    Spectrum diffuse, lobe;
    for (int band = 0; band < bandCount; ++band) {
        const auto layer = kubelkaMunkLayer<double>(film.absorption[band], film.scattering[band], d);
        diffuse[band] = static_cast<float>(overBackground<double>(layer, copper.reflectance[band]));
        lobe[band] = static_cast<float>(copper.reflectance[band] * layer.transmittance * layer.transmittance);
    }
    expectNear(out.diffuse, V3f(linearRec709(diffuse)), 1e-5f);
    expectNear(out.lobes[0].colour, V3f(linearRec709(lobe)), 1e-5f);
    expectNear(out.lobes[1].colour, film.specularColour, 1e-6f);
    // Bare metal shows why this is not the default: diffuse and specular are both the whole of it.
    EXPECT_GT(test::total(look({"copper"}, {}, OpticsModel::paper)).x, 1.5f);
}

TEST(LayerStack, refusesAStackWithoutABase) {
    EXPECT_THROW(StackOptics(std::vector<const Material*>{}), RunError);
    const std::vector<const Material*> many(StackOptics::maxLayers + 2, &shippedMaterials().at("copper"));
    EXPECT_THROW(StackOptics{many}, RunError);
}

// A machine without the instruction makes it from sums and products in double precision.
TEST(StackKernel, aProductAndASumAreRoundedOnceOnEveryMachine) {
    Uniforms uniforms("fused");
    const auto number = [&] {
        const float size = std::ldexp(1.f + static_cast<float>(uniforms()), uniforms.below(40) - 20);
        return uniforms() < 0.5 ? size : -size;
    };
    for (int i = 0; i < 200000; ++i) {
        Register<4>::Floats a, b, c;
        for (int k = 0; k < 4; ++k) {
            a[k] = number();
            b[k] = number();
            // Any, or one that leaves only what rounding the product would lose, or one half a last place away from it.
            const int kind = uniforms.below(3);
            c[k] = kind == 0 ? number() : kind == 1 ? -a[k] * b[k] : std::ldexp(a[k] * b[k], -24);
        }
        const Register<4>::Floats sum = fusedRegister(a, b, c);
        for (int k = 0; k < 4; ++k) {
            ASSERT_EQ(sum[k], std::fma(a[k], b[k], c[k])) << a[k] << " " << b[k] << " " << c[k];
        }
    }
}

// Machines differ in the width of their registers; results must not.
TEST(StackKernel, everyRegisterWidthGivesTheSameBits) {
    Uniforms uniforms("widths");
    const ChannelWeights weights = channelWeights(rec709BandWeights());
    for (int i = 0; i < 500; ++i) {
        const test::RandomStack stack = test::randomStack(uniforms);
        std::vector<LayerSpectra> optics(stack.materials.size());
        KernelInput input;
        input.count = static_cast<int>(stack.thicknessUm.size());
        input.base = &stack.materials[0]->reflectance;
        input.weights = &weights;
        input.k1 = 0.04f;
        input.k2 = 0.6f;
        input.wantEdge = true;
        for (int k = 0; k < input.count; ++k) {
            const Material& material = *stack.materials[k + 1];
            for (int band = 0; band < bandCount; ++band) {
                optics[k].setBand(band, material.absorption[band], material.scattering[band]);
            }
            input.layers[k] = {&optics[k], &stack.materials[0]->reflectance, stack.thicknessUm[k], 0.01f};
        }
        KernelOutput narrow, narrowPaper;
        Spectrum narrowBody;
        stackKernel(4).foldPaper(input, narrowPaper);
        stackKernel(4).foldConserving(input, narrow);
        stackKernel(4).foldBody(input, narrowBody);
        for (int width : {8, 16}) {
            KernelOutput wide, widePaper;
            Spectrum wideBody;
            stackKernel(width).foldPaper(input, widePaper);
            stackKernel(width).foldConserving(input, wide);
            stackKernel(width).foldBody(input, wideBody);
            ASSERT_EQ(narrowBody.values, wideBody.values);
            for (int c = 0; c < 3; ++c) {
                ASSERT_EQ(narrow.diffuse[c], wide.diffuse[c]);
                ASSERT_EQ(narrow.edge[c], wide.edge[c]);
                ASSERT_EQ(narrowPaper.diffuse[c], widePaper.diffuse[c]);
                for (int k = 0; k <= input.count; ++k) {
                    ASSERT_EQ(narrow.lobes[k][c], wide.lobes[k][c]);
                    ASSERT_EQ(narrowPaper.lobes[k][c], widePaper.lobes[k][c]);
                }
            }
        }
    }
}

} // namespace
} // namespace patina
