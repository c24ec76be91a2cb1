#pragma once
// The loops of BsdfBatch.

#include "optics/microfacet.h"

#include <cstddef>

namespace patina {

/// The numbers of a lobe, each an array of lanes.
enum LobeNumber : int {
    bodyX,
    bodyY,
    bodyZ,
    bodyEdgeX,
    bodyEdgeY,
    bodyEdgeZ,
    lobeAir,
    lobeAirEdge,
    lobeAlpha,
    lobeExponent,
    lobeRowWeight,
    lobeChance,  ///< of drawing from it, times the total
    lobeSlope,   ///< sqrt(cos² + alpha² sin²) of wo
    lobeDensity, ///< times D(h) it is the lobe's part of the density
    lobeNumbers
};

/// A batch as its loops see it: arrays of `count` lanes, a multiple of 16, and lobe by lobe.
struct BsdfLanes {
    std::size_t count;
    std::size_t stride; ///< between the numbers of a lobe
    int lobes;
    bool anyAir;
    float* numbers;      ///< of lobe k, number n: from (k · lobeNumbers + n) · stride on
    const int* rowBelow; ///< of lobe k: from k · stride on
    AlbedoGrid albedo;
    const float *diffuseX, *diffuseY, *diffuseZ;
    const float *diffuseNormaliser, *passNormaliser;
    const float *woX, *woY, *woZ;
    float *pass, *diffuseChance, *total;

    float* lobe(int k) const { return numbers + std::size_t(k) * std::size_t(lobeNumbers) * stride; }
};

void seeLanes(const BsdfLanes& lanes);

struct EvaluateLanes {
    BsdfLanes bsdf;
    const float *wiX, *wiY, *wiZ;
    float *valueX, *valueY, *valueZ, *pdf;
};
void evaluateLanes(const EvaluateLanes& lanes);

struct SampleLanes {
    BsdfLanes bsdf;
    const float *u1, *u2, *u3;
    float *wiX, *wiY, *wiZ;
};
/// Directions alone: what they are worth evaluateLanes() tells.
void sampleLanes(const SampleLanes& lanes);

} // namespace patina
