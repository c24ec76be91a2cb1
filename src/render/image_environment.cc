#include "render/image_environment.h"

#include "base/errors.h"
#include "base/turns.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

float decodedSrgb(float c) {
    return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

} // namespace

ImageEnvironment::ImageEnvironment(Image panorama, UpAxis up, float turnDegrees, float strength)
    : panorama_(std::move(panorama)), set_(uprightFrame(up, turnDegrees)) {
    if (panorama_.height < 2 || panorama_.width != 2 * panorama_.height || panorama_.channels < 3)
        throw RunError("environment", fmt::format("the panorama has {} × {} pixels", panorama_.width, panorama_.height),
                       "it must be twice as wide as high, in colour, in equal steps of azimuth and elevation");
    if (!(strength >= 0.f) || !std::isfinite(strength))
        throw RunError("environment", "its strength must be 0 or more");
    for (int y = 0; y < panorama_.height; ++y)
        for (int x = 0; x < panorama_.width; ++x) {
            const Imath::V3f c = panorama_.rgb(x, y);
            if (!(std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z) && c.x >= 0.f && c.y >= 0.f &&
                  c.z >= 0.f))
                throw RunError("environment",
                               fmt::format("the panorama's pixel at column {}, row {} is negative or not finite", x, y),
                               "mend the picture: light must be 0 or more");
        }
    for (float& c : panorama_.pixels)
        c *= strength;
}

int ImageEnvironment::looksPerCell() const {
    // The tables' cells are 1.9 degrees wide; no pixel shall fall between two looks.
    return std::clamp(panorama_.width / 192 + 1, 3, 16);
}

Imath::V3f ImageEnvironment::radiance(const Imath::V3f& direction) const {
    const Imath::V3f d = set_.toLocal(direction);
    // Ahead, away from the viewer, is +bitangent; to the viewer's right +tangent.
    const float x = (turnOf(d.y, d.x) + 0.5f) * float(panorama_.width) + 0.5f;
    const float y = halfTurnsOfCosine(d.z) * float(panorama_.height) + 0.5f;
    // Counted from -1: a turn around, and half a pixel. The poles have no other side here.
    const int width = panorama_.width, last = panorama_.height - 1;
    const int left = int(x) - 1, top = int(y) - 1;
    const float fx = x - float(left + 1), fy = y - float(top + 1);
    const int column = left < 0 ? width - 1 : std::min(left, width - 1);
    const int next = column + 1 < width ? column + 1 : 0;
    const int upper = std::max(top, 0), lower = std::min(top + 1, last);
    const Imath::V3f above = panorama_.rgb(column, upper) * (1.f - fx) + panorama_.rgb(next, upper) * fx;
    const Imath::V3f below = panorama_.rgb(column, lower) * (1.f - fx) + panorama_.rgb(next, lower) * fx;
    return above * (1.f - fy) + below * fy;
}

Image readPanorama(const std::filesystem::path& path) {
    const auto input = OIIO::ImageInput::open(path.string());
    if (!input)
        throw RunError(path.string(), "the panorama cannot be read: " + OIIO::geterror(),
                       "give an OpenEXR or Radiance HDR picture");
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.nchannels < 3)
        throw RunError(path.string(), "the panorama has no colour");
    if (std::int64_t(spec.width) * spec.height > std::int64_t(1) << 28)
        throw RunError(path.string(), fmt::format("the panorama has {} × {} pixels", spec.width, spec.height),
                       "8192 × 4096 are enough for any light");
    Image image(spec.width, spec.height);
    if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, image.pixels.data()))
        throw RunError(path.string(), "the panorama cannot be read: " + input->geterror());
    const bool encoded = spec.format == OIIO::TypeDesc::UINT8 || spec.format == OIIO::TypeDesc::UINT16;
    if (encoded)
        for (float& c : image.pixels)
            c = decodedSrgb(c);
    return image;
}

} // namespace patina
