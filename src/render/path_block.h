#pragma once
// The paths of a small block of pixels: their camera's rays are traced in packets, what follows path by path. (Rays
// that a surface scatters are slower in packets than alone: they go different ways.)

#include "base/random.h"
#include "render/camera.h"
#include "render/image.h"
#include "render/path_walk.h"

#include <cstdint>
#include <vector>

namespace patina {

/// Keeps its storage from one block to the next; one for each thread.
class PathBlock {
  public:
    static constexpr int size = 4; ///< pixels each way

    PathBlock(const PathSetting& setting, const Camera& camera, const KeyedRandom& random);

    /// Adds samples first … last - 1 of each pixel of the block, which begins at (left, top), to its sum.
    /// Packets hold samples of 2^k … 2^(k+1) - 1, or of 32 from a multiple of 32 on: a picture's bits do not depend on
    /// where rounds of samples begin and end, if they do so there.
    /// \returns rays traced
    std::uint64_t addSamples(Image& image, int left, int top, int first, int last);

  private:
    struct Pixel {
        int x, y;
        PixelSampler sampler;
        Imath::V3f sum;
    };
    /// Camera rays of samples first … last - 1 of a pixel.
    void aim(Pixel& pixel, int first, int last);
    /// Traces what is in the packet and follows it.
    void trace(int samples, int first);

    const PathSetting& setting_;
    const Camera& camera_;
    const KeyedRandom& random_;
    int lensDraw_; ///< behind those of a path's surfaces
    std::vector<Pixel> pixels_;
    RayScene::Packet packet_;
    int traced_ = 0; ///< of this group of samples
    std::vector<float> random1_, random2_, lens1_, lens2_;
    CameraRays cameraRays_;
    std::uint64_t rays_ = 0;
};

} // namespace patina
