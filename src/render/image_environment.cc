#include "render/image_environment.h"

#include "base/errors.h"
#include "base/lane_kernel.h"
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

PATINA_LANE_BODY int within(int i, int last) {
    const int least = i < 0 ? 0 : i;
    return least < last ? least : last;
}

struct Panorama {
    const float* pixels;
    int width, height, channels;
    Frame set;
};

PATINA_LANE_BODY void look(const Panorama& panorama, float dx, float dy, float dz, float& red, float& green,
                           float& blue) {
    const Frame& set = panorama.set;
    const float right = dx * set.tangent.x + dy * set.tangent.y + dz * set.tangent.z;
    const float ahead = dx * set.bitangent.x + dy * set.bitangent.y + dz * set.bitangent.z;
    const float up = dx * set.normal.x + dy * set.normal.y + dz * set.normal.z;
    // Ahead, away from the viewer, is +bitangent; to the viewer's right +tangent.
    const int width = panorama.width, last = panorama.height - 1, channels = panorama.channels;
    const float x = (turnOf(ahead, right) + 0.5f) * float(width) + 0.5f;
    const float y = halfTurnsOfCosine(up) * float(panorama.height) + 0.5f;
    // Counted from -1: a turn around, and half a pixel. The poles have no other side here.
    const int left = int(x) - 1, top = int(y) - 1;
    const float fx = x - float(left + 1), fy = y - float(top + 1), gx = 1.f - fx, gy = 1.f - fy;
    const int column = left < 0 ? width - 1 : within(left, width - 1);
    const int next = column + 1 < width ? column + 1 : 0;
    const int upper = within(top, last) * width, lower = within(top + 1, last) * width;
    const float* pixels = panorama.pixels;
    const int a = (upper + column) * channels, b = (upper + next) * channels, c = (lower + column) * channels,
              d = (lower + next) * channels;
    red = (pixels[a] * gx + pixels[b] * fx) * gy + (pixels[c] * gx + pixels[d] * fx) * fy;
    green = (pixels[a + 1] * gx + pixels[b + 1] * fx) * gy + (pixels[c + 1] * gx + pixels[d + 1] * fx) * fy;
    blue = (pixels[a + 2] * gx + pixels[b + 2] * fx) * gy + (pixels[c + 2] * gx + pixels[d + 2] * fx) * fy;
}

struct PanoramaLanes {
    const RadianceLanes& lanes;
    const Panorama panorama;
};

PATINA_LANE_BODY void panoramaLanesBody(const PanoramaLanes& looks) {
    const RadianceLanes& lanes = looks.lanes;
    const Panorama panorama = looks.panorama;
    const ConstVectors direction = lanes.direction;
    const Vectors radiance = lanes.radiance;
    const std::size_t count = (lanes.count + 15) / 16 * 16;
    PATINA_LANES
    for (std::size_t i = 0; i < count; ++i)
        look(panorama, direction.x[i], direction.y[i], direction.z[i], radiance.x[i], radiance.y[i], radiance.z[i]);
}

PATINA_LANE_KERNEL(panoramaLanes, PanoramaLanes)

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
    Imath::V3f result;
    look({panorama_.pixels.data(), panorama_.width, panorama_.height, panorama_.channels, set_}, direction.x,
         direction.y, direction.z, result.x, result.y, result.z);
    return result;
}

void ImageEnvironment::radiance(const RadianceLanes& lanes) const {
    panoramaLanes({lanes, {panorama_.pixels.data(), panorama_.width, panorama_.height, panorama_.channels, set_}});
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
