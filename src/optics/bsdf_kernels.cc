#include "optics/bsdf_kernels.h"

#include "base/lane_kernel.h"

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

constexpr float pi = 3.14159265358979f;
// Lanes whose intermediate results are kept at once: they stay in the nearest cache.
constexpr std::size_t block = 64;

PATINA_LANE_BODY float greater(float a, float b) {
    return a > b ? a : b;
}

// What the air lets through at these cosines: PatinaBsdf::passThroughAir().
PATINA_LANE_BODY void passThroughAir(const BsdfLanes& lanes, std::size_t first, std::size_t count, const float* cosines,
                                     float* pass) {
    if (!lanes.anyAir) {
        PATINA_LANES
        for (std::size_t i = 0; i < count; ++i)
            pass[i] = 1.f;
        return;
    }
    float reflected[block], weight[block];
    int below[block];
    const int columns = lanes.albedo.columns;
    PATINA_LANES
    for (std::size_t i = 0; i < count; ++i) {
        const float cosine = cosines[i];
        const float inside = cosine < 0.f ? 0.f : cosine > 1.f ? 1.f : cosine;
        const float scaled = std::sqrt(inside) * float(columns - 1);
        const int whole = int(scaled);
        below[i] = whole < columns - 2 ? whole : columns - 2;
        weight[i] = scaled - float(below[i]);
        reflected[i] = 0.f;
    }
    const float* table = lanes.albedo.values;
    for (int k = 0; k < lanes.lobes; ++k) {
        const float* air = lanes.lobe(k) + lobeAir * lanes.stride + first;
        const float* airEdge = lanes.lobe(k) + lobeAirEdge * lanes.stride + first;
        const float* rowWeight = lanes.lobe(k) + lobeRowWeight * lanes.stride + first;
        const int* rowBelow = lanes.rowBelow + std::size_t(k) * lanes.stride + first;
        PATINA_LANES
        for (std::size_t i = 0; i < count; ++i) {
            const int low = 2 * (rowBelow[i] * columns + below[i]), high = low + 2 * columns;
            const float w = weight[i], r = rowWeight[i];
            const float lowFlat = table[low] + w * (table[low + 2] - table[low]);
            const float lowRising = table[low + 1] + w * (table[low + 3] - table[low + 1]);
            const float highFlat = table[high] + w * (table[high + 2] - table[high]);
            const float highRising = table[high + 1] + w * (table[high + 3] - table[high + 1]);
            const float flat = lowFlat + r * (highFlat - lowFlat), rising = lowRising + r * (highRising - lowRising);
            const float mine = air[i] * flat + airEdge[i] * rising;
            reflected[i] += airEdge[i] > 0.f ? mine : 0.f;
        }
    }
    PATINA_LANES
    for (std::size_t i = 0; i < count; ++i)
        pass[i] = greater(1.f - reflected[i], 0.f);
}

PATINA_LANE_BODY void seeLanesBody(const BsdfLanes& lanes) {
    for (std::size_t first = 0; first < lanes.count; first += block) {
        const std::size_t count = std::min(block, lanes.count - first);
        const float* woZ = lanes.woZ + first;
        float* total = lanes.total + first;
        PATINA_LANES
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t lane = first + i;
            const float most =
                greater(greater(greater(lanes.diffuseX[lane], lanes.diffuseY[lane]), lanes.diffuseZ[lane]), 0.f);
            lanes.diffuseChance[lane] = most;
            total[i] = most;
        }
        for (int k = 0; k < lanes.lobes; ++k) {
            float* n = lanes.lobe(k) + first;
            const std::size_t step = lanes.stride;
            PATINA_LANES
            for (std::size_t i = 0; i < count; ++i) {
                const float c = woZ[i], s = schlickWeight(c), sine2 = greater(1.f - c * c, 0.f);
                const float x = n[i] + (n[bodyEdgeX * step + i] - n[i]) * s;
                const float y = n[bodyY * step + i] + (n[bodyEdgeY * step + i] - n[bodyY * step + i]) * s;
                const float z = n[bodyZ * step + i] + (n[bodyEdgeZ * step + i] - n[bodyZ * step + i]) * s;
                const float air = n[lobeAir * step + i], airEdge = n[lobeAirEdge * step + i],
                            alpha = n[lobeAlpha * step + i];
                const float chance = greater(greater(greater(x, y), z), 0.f) + air + (airEdge - air) * s;
                const float slope = std::sqrt(c * c + alpha * alpha * sine2);
                n[lobeChance * step + i] = chance;
                n[lobeSlope * step + i] = slope;
                n[lobeDensity * step + i] = 0.5f * chance / (c + slope);
                total[i] += chance;
            }
        }
        passThroughAir(lanes, first, count, woZ, lanes.pass + first);
        PATINA_LANES
        for (std::size_t i = 0; i < count; ++i)
            total[i] = woZ[i] > 0.f ? total[i] : 0.f;
    }
}

PATINA_LANE_BODY void evaluateLanesBody(const EvaluateLanes& lanes) {
    const BsdfLanes& bsdf = lanes.bsdf;
    for (std::size_t first = 0; first < bsdf.count; first += block) {
        const std::size_t count = std::min(block, bsdf.count - first);
        const float *woX = bsdf.woX + first, *woY = bsdf.woY + first, *woZ = bsdf.woZ + first;
        const float *wiX = lanes.wiX + first, *wiY = lanes.wiY + first, *wiZ = lanes.wiZ + first;
        float *valueX = lanes.valueX + first, *valueY = lanes.valueY + first, *valueZ = lanes.valueZ + first;
        float* pdf = lanes.pdf + first;
        float sine2OfHalf[block], cosine2OfHalf[block], schlick[block], sine2[block], passBody[block];
        passThroughAir(bsdf, first, count, wiZ, passBody);
        PATINA_LANES
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t lane = first + i;
            const float x = woX[i] + wiX[i], y = woY[i] + wiY[i], z = woZ[i] + wiZ[i];
            const float twice = std::sqrt(x * x + y * y + z * z);
            const float hx = x / twice, hy = y / twice, hz = z / twice;
            sine2OfHalf[i] = hx * hx + hy * hy;
            cosine2OfHalf[i] = hz;
            schlick[i] = schlickWeight(0.5f * twice);
            const float pass = bsdf.pass[lane] * passBody[i];
            passBody[i] = pass * bsdf.passNormaliser[lane];
            sine2[i] = greater(1.f - wiZ[i] * wiZ[i], 0.f);
            const float scale = pass * bsdf.diffuseNormaliser[lane] / pi;
            valueX[i] = bsdf.diffuseX[lane] * scale;
            valueY[i] = bsdf.diffuseY[lane] * scale;
            valueZ[i] = bsdf.diffuseZ[lane] * scale;
            pdf[i] = bsdf.diffuseChance[lane] * wiZ[i] / pi;
        }
        for (int k = 0; k < bsdf.lobes; ++k) {
            const float* n = bsdf.lobe(k) + first;
            const std::size_t step = bsdf.stride;
            PATINA_LANES
            for (std::size_t i = 0; i < count; ++i) {
                const float alpha = n[lobeAlpha * step + i], a2 = alpha * alpha, hz = cosine2OfHalf[i], s = schlick[i];
                const float t = hz * hz * a2 + sine2OfHalf[i];
                const float d = a2 / (pi * t * t);
                pdf[i] += n[lobeDensity * step + i] * d;
                const float slope = std::sqrt(wiZ[i] * wiZ[i] + alpha * alpha * sine2[i]);
                const float facets = d * 0.5f / greater(wiZ[i] * n[lobeSlope * step + i] + woZ[i] * slope, 1e-9f);
                const float air = n[lobeAir * step + i] + (n[lobeAirEdge * step + i] - n[lobeAir * step + i]) * s;
                const float x = (n[i] + (n[bodyEdgeX * step + i] - n[i]) * s) * passBody[i] + air;
                const float y =
                    (n[bodyY * step + i] + (n[bodyEdgeY * step + i] - n[bodyY * step + i]) * s) * passBody[i] + air;
                const float z =
                    (n[bodyZ * step + i] + (n[bodyEdgeZ * step + i] - n[bodyZ * step + i]) * s) * passBody[i] + air;
                valueX[i] += x * facets;
                valueY[i] += y * facets;
                valueZ[i] += z * facets;
            }
        }
        PATINA_LANES
        for (std::size_t i = 0; i < count; ++i) {
            const float all = bsdf.total[first + i];
            const bool seen = woZ[i] > 0.f && wiZ[i] > 0.f;
            const float share = pdf[i] / all;
            pdf[i] = seen && all > 0.f ? share : 0.f;
            valueX[i] = seen ? valueX[i] : 0.f;
            valueY[i] = seen ? valueY[i] : 0.f;
            valueZ[i] = seen ? valueZ[i] : 0.f;
        }
    }
}

PATINA_LANE_BODY void sampleLanesBody(const SampleLanes& lanes) {
    const BsdfLanes& bsdf = lanes.bsdf;
    for (std::size_t first = 0; first < bsdf.count; first += block) {
        const std::size_t count = std::min(block, bsdf.count - first);
        float choice[block], alpha[block];
        int found[block]; // 0: no lobe yet, 1: the one before may be it, 2: it is; 3: the diffuse part
        const float *u1 = lanes.u1 + first, *u2 = lanes.u2 + first, *u3 = lanes.u3 + first;
        const float *woX = bsdf.woX + first, *woY = bsdf.woY + first, *woZ = bsdf.woZ + first;
        float *wiX = lanes.wiX + first, *wiY = lanes.wiY + first, *wiZ = lanes.wiZ + first;
        PATINA_LANES
        for (std::size_t i = 0; i < count; ++i) {
            choice[i] = u3[i] * bsdf.total[first + i] - bsdf.diffuseChance[first + i];
            alpha[i] = 1.f;
            found[i] = choice[i] < 0.f ? 3 : 0;
        }
        for (int k = 0; k < bsdf.lobes; ++k) {
            const float* chances = bsdf.lobe(k) + lobeChance * bsdf.stride + first;
            const float* widths = bsdf.lobe(k) + lobeAlpha * bsdf.stride + first;
            PATINA_LANES
            for (std::size_t i = 0; i < count; ++i) {
                const float chance = chances[i];
                const bool open = found[i] < 2 && chance > 0.f;
                alpha[i] = open ? widths[i] : alpha[i];
                found[i] = open ? (choice[i] < chance ? 2 : 1) : found[i];
                choice[i] = open ? choice[i] - chance : choice[i];
            }
        }
        PATINA_LANES
        for (std::size_t i = 0; i < count; ++i) {
            const float a = u1[i], x = woX[i], y = woY[i], z = woZ[i];
            const CirclePoint around = circlePoint(u2[i]);
            const float radius = std::sqrt(a);
            const float mattX = radius * around.cosine, mattY = radius * around.sine;
            const float mattZ = std::sqrt(greater(0.f, 1.f - a));
            float hx, hy, hz;
            sampleVisibleNormal(x, y, z, alpha[i], a, u2[i], hx, hy, hz);
            const float twice = 2.f * (x * hx + y * hy + z * hz);
            const float glossX = twice * hx - x, glossY = twice * hy - y, glossZ = twice * hz - z;
            const bool matt = found[i] == 0 || found[i] == 3;
            wiX[i] = matt ? mattX : glossX;
            wiY[i] = matt ? mattY : glossY;
            wiZ[i] = matt ? mattZ : glossZ;
        }
    }
}

} // namespace

PATINA_LANE_KERNEL(seeLanes, BsdfLanes)
PATINA_LANE_KERNEL(evaluateLanes, EvaluateLanes)
PATINA_LANE_KERNEL(sampleLanes, SampleLanes)

} // namespace patina
