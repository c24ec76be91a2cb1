#pragma once
// The picture: light transport by path tracing.

#include "base/progress.h"
#include "render/camera.h"
#include "render/image.h"
#include "render/lights.h"
#include "render/scene.h"

#include <cstdint>

namespace patina {

struct RenderOptions {
    int width = 640;
    int height = 640;
    int samples = 32; ///< paths per pixel; powers of two are spread most evenly
    int maxDepth = 4; ///< surfaces a path may visit, 1: direct light only
    /// Light that arrives after two or more bounces counts at most this much per path, 1 is about white: no fireflies,
    /// but too little light where a sun is seen twice reflected. 0: no bound, and no bias.
    float indirectClamp = 6.f;
    std::uint64_t seed = 0;
    /// Above 0: samples are taken in rounds (1, 1, 2, 4 … to each pixel) and no round begins that would end after this
    /// many seconds. The picture is then that of `Rendering::samples`, to the bit. 0: all samples.
    double seconds = 0.0;
    /// Above 0: 8 × 8 pixels take no more samples, after 8, 16, 32 …, once the noise of each 4 × 4 of them is below
    /// this: the standard error that their halves tell, in sRGB-encoded steps of an 8-bit file. 0, or with `seconds`: all
    /// samples.
    float noise = 0.f;
};

struct Rendering {
    Image image;                   ///< linear Rec.709 light
    std::uint64_t rays = 0;        ///< traced, shadow rays included
    int samples = 0;               ///< taken of each pixel, at most
    double seconds = 0.0;          ///< that tracing took, the scene's and the lights' setting up left out
    double processorSeconds = 0.0; ///< that the process's threads worked meanwhile, together
    double samplesPerPixel = 0.0;  ///< taken on average
};

/// Path tracing with multiple importance sampling between lights and BSDF (power heuristic), a tent filter of one
/// pixel's radius and Russian roulette from the third surface on. The same bits on any number of threads.
/// \throws RunError where there is nothing to render, an option is out of range or the camera stands inside the object;
/// Interrupted.
Rendering render(const RenderScene& scene, const Camera& camera, const Lights& lights, const RenderOptions& options,
                 Progress& progress);

} // namespace patina
