#pragma once
// The loops over lanes of a batch of paths. Arrays have room up to the next multiple of 16, to which `count` is
// rounded.

#include "base/vector_lanes.h"

#include <cstddef>
#include <cstdint>

namespace patina {

struct Frames {
    Vectors tangent, bitangent, normal;
};

/// Owen-scrambled Sobol' points as PixelSampler's: lane i is path[i], whose pixel and sample say which.
struct DrawLanes {
    std::size_t count;
    const int* path;
    const std::int32_t* pixelOf;
    const std::uint32_t* sampleOf;
    const std::uint32_t *seed0, *seed1, *seed2; ///< of each pixel
    float *u, *v;
};
void drawLanes(const DrawLanes& lanes);

/// Where rays met triangles, as Stage's points.
struct ShadeLanes {
    std::size_t count;
    const int* from; ///< of each lane: place in the arrays of rays and hits
    const int* triangle;
    const float *u, *v;
    ConstVectors geometricNormal, direction;
    const int* triangles; ///< of the mesh, three corners each
    const float *positions, *normals;
    float clearance;
    Vectors position, origin;
    Frames shading;
    Vectors wo; ///< towards where the ray came from, local
};
void shadeLanes(const ShadeLanes& lanes);

/// Directions for light that is the same from everywhere, by the cosine.
struct SkyLanes {
    std::size_t count;
    ConstVectors normal;
    const float *u, *v;
    Vectors direction;
    float* density; ///< 0: nothing to see
};
void skyLanes(const SkyLanes& lanes);

/// Directions in lanes' own frames.
struct LocalLanes {
    std::size_t count;
    Frames frame;
    ConstVectors world;
    Vectors local;
};
void localLanes(const LocalLanes& lanes);

/// What arrives at the camera of light that is looked at, if nothing is between.
struct ArriveLanes {
    std::size_t count;
    ConstVectors wi, value, radiance, throughput;
    const float *pdf, *density; ///< of drawing wi by the BSDF, and by the light
    const char* lightsDone;     ///< the light's share counts whole
    float bound;                ///< of what arrives; 0: none
    Vectors light;
    float* most; ///< of the three; 0: nothing to trace for
};
void arriveLanes(const ArriveLanes& lanes);

/// On along what the BSDF drew.
struct GoOnLanes {
    std::size_t count;
    Frames frame;
    ConstVectors wi, value;
    const float* pdf;
    Vectors throughput; ///< times f cos / pdf
    Vectors direction;
    float *most, *weight; ///< the largest of the throughput's and of the factor's channels; 0 where the path ends
};
void goOnLanes(const GoOnLanes& lanes);

} // namespace patina
