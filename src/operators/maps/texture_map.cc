#include "operators/maps/texture_map.h"

#include "base/errors.h"
#include "operators/maps/image_channels.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace patina {

namespace {

class TextureMap : public ThicknessMap {
  public:
    TextureMap(const SurfaceMesh& surface, int width, int height, std::vector<float> pixels)
        : surface_(surface), width_(width), height_(height), pixels_(std::move(pixels)) {}

    double value(const MapPoint& point) const override {
        const Imath::V2d uv = uvAt(surface_, {point.triangle, point.u, point.v});
        const double x = uv.x * width_ - 0.5, y = (1.0 - uv.y) * height_ - 0.5;
        const double fx = std::floor(x), fy = std::floor(y);
        const double ax = x - fx, ay = y - fy;
        const double top = (1 - ax) * at(fx, fy) + ax * at(fx + 1, fy);
        const double bottom = (1 - ax) * at(fx, fy + 1) + ax * at(fx + 1, fy + 1);
        return (1 - ay) * top + ay * bottom;
    }

  private:
    double at(double x, double y) const {
        const auto wrap = [](double i, int n) { return static_cast<int>(i - std::floor(i / n) * n); };
        const int column = std::min(wrap(x, width_), width_ - 1), row = std::min(wrap(y, height_), height_ - 1);
        return pixels_[static_cast<std::size_t>(row) * width_ + column];
    }

    const SurfaceMesh& surface_;
    int width_, height_;
    std::vector<float> pixels_;
};

// Which channels make the value, with their weights.
std::vector<std::pair<int, float>> channelWeights(const OIIO::ImageSpec& spec, const std::string& channel,
                                                  const std::string& file) {
    if (channel.empty()) {
        if (spec.nchannels >= 3)
            return {{0, 0.2126f}, {1, 0.7152f}, {2, 0.0722f}};
        return {{0, 1.f}};
    }
    if (const auto found = ImageChannels(spec.channelnames).find(channel))
        return {{*found, 1.f}};
    throw RunError(file, fmt::format("the image has no channel '{}'", channel),
                   fmt::format("it has {}", fmt::join(spec.channelnames, ", ")));
}

} // namespace

ThicknessMapPtr makeTextureMap(const SurfaceMesh& surface, const std::filesystem::path& file,
                               const std::string& channel) {
    if (!surface.hasUvs())
        throw ModelError("model", fmt::format("has no UVs, and texture(\"{}\") needs them", file.string()),
                         "give a model with UVs, or use noise, turbulence or vertices(…)");
    const auto input = OIIO::ImageInput::open(file.string());
    if (!input)
        throw RunError(file.string(), fmt::format("cannot be read as an image: {}", OIIO::geterror()));
    const OIIO::ImageSpec spec = input->spec();
    const auto weights = channelWeights(spec, channel, file.string());
    std::vector<float> all(static_cast<std::size_t>(spec.width) * spec.height * spec.nchannels);
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, all.data()))
        throw RunError(file.string(), fmt::format("cannot be read: {}", input->geterror()));
    std::vector<float> pixels(static_cast<std::size_t>(spec.width) * spec.height, 0.f);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        for (const auto& [index, weight] : weights)
            pixels[i] += weight * all[i * spec.nchannels + index];
        if (!std::isfinite(pixels[i]))
            throw RunError(file.string(),
                           fmt::format("pixel ({}, {}) is not a number", i % spec.width, i / spec.width));
    }
    return std::make_shared<TextureMap>(surface, spec.width, spec.height, std::move(pixels));
}

} // namespace patina
