#pragma once
// A picture in memory.

#include <Imath/ImathVec.h>

#include <cstddef>
#include <vector>

namespace patina {

/// Rows from the top, pixels from the left, channels interleaved. Whether the numbers are linear light or encoded for
/// a display is said by the function that gives or takes the picture.
struct Image {
    int width = 0;
    int height = 0;
    int channels = 3;
    std::vector<float> pixels;

    Image() = default;
    Image(int width, int height, int channels = 3, float value = 0.f)
        : width(width), height(height), channels(channels),
          pixels(std::size_t(width) * std::size_t(height) * std::size_t(channels), value) {}

    float* at(int x, int y) { return pixels.data() + index(x, y); }
    const float* at(int x, int y) const { return pixels.data() + index(x, y); }
    Imath::V3f rgb(int x, int y) const { return {at(x, y)[0], at(x, y)[1], at(x, y)[2]}; }
    void setRgb(int x, int y, const Imath::V3f& c) {
        float* p = at(x, y);
        p[0] = c.x, p[1] = c.y, p[2] = c.z;
    }
    bool empty() const { return width <= 0 || height <= 0; }

  private:
    std::size_t index(int x, int y) const {
        return (std::size_t(y) * std::size_t(width) + std::size_t(x)) * std::size_t(channels);
    }
};

} // namespace patina
