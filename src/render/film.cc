#include "render/film.h"

#include "base/atomic_file.h"
#include "base/errors.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace patina {

namespace {

float encode(float linear) {
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.f / 2.4f) - 0.055f;
}

// A fixed pattern in -0.5…0.5 in which neighbours differ most ("interleaved gradient noise", Jimenez 2014).
float ditherPattern(int x, int y) {
    const float t = 0.06711056f * float(x) + 0.00583715f * float(y);
    const float s = 52.9829189f * (t - std::floor(t));
    return s - std::floor(s) - 0.5f;
}

} // namespace

float filmicShoulder(float linear) {
    // Slope 1 at the knee, then exponentially towards white: no kink, no hue shift below the knee.
    constexpr float knee = 0.6f;
    if (linear <= knee)
        return linear;
    return knee + (1.f - knee) * (1.f - std::exp(-(linear - knee) / (1.f - knee)));
}

Image displayImage(const Image& linear, const ViewOptions& options) {
    Image out(linear.width, linear.height, linear.channels);
    const float gain = std::exp2(options.exposureStops);
    for (int y = 0; y < linear.height; ++y)
        for (int x = 0; x < linear.width; ++x) {
            const float* from = linear.at(x, y);
            float* to = out.at(x, y);
            const float offset = options.dither ? ditherPattern(x, y) / 255.f : 0.f;
            for (int c = 0; c < linear.channels; ++c) {
                float light = std::isfinite(from[c]) ? std::max(0.f, from[c] * gain) : 0.f;
                if (options.transform == ViewTransform::filmic)
                    light = filmicShoulder(light);
                const float encoded = encode(std::min(light, 1.f));
                to[c] = encoded > 0.f && encoded < 1.f ? std::clamp(encoded + offset, 0.f, 1.f) : encoded;
            }
        }
    return out;
}

void writePng(const Image& encoded, const std::filesystem::path& path, const ImageMetadata& metadata) {
    if (encoded.empty())
        throw RunError(path.string(), "there is no picture to write");
    std::vector<std::uint8_t> bytes(encoded.pixels.size());
    std::transform(encoded.pixels.begin(), encoded.pixels.end(), bytes.begin(), [](float v) {
        return std::uint8_t(std::isfinite(v) ? std::lround(std::clamp(v, 0.f, 1.f) * 255.f) : 0);
    });

    AtomicFile file(path);
    auto output = OIIO::ImageOutput::create(file.temporary().string());
    if (!output)
        throw RunError(path.string(), "cannot write this kind of picture: " + OIIO::geterror(), "name it .png");
    OIIO::ImageSpec spec(encoded.width, encoded.height, encoded.channels, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("png:compressionLevel", 6);
    for (const auto& [name, text] : metadata)
        spec.attribute(name, text);
    if (!output->open(file.temporary().string(), spec) || !output->write_image(OIIO::TypeDesc::UINT8, bytes.data()) ||
        !output->close())
        throw RunError(path.string(), "cannot write the picture: " + output->geterror());
    file.commit();
}

Image readPng(const std::filesystem::path& path, ImageMetadata* metadata) {
    auto input = OIIO::ImageInput::open(path.string());
    if (!input)
        throw RunError(path.string(), "cannot read the picture: " + OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    Image image(spec.width, spec.height, spec.nchannels);
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels.data()))
        throw RunError(path.string(), "cannot read the picture: " + input->geterror());
    if (metadata)
        for (const auto& attribute : spec.extra_attribs)
            if (attribute.type() == OIIO::TypeDesc::STRING)
                (*metadata)[attribute.name().string()] = attribute.get_string();
    return image;
}

Image asRgb(const Image& picture) {
    if (picture.channels == 3)
        return picture;
    Image rgb(picture.width, picture.height);
    const int colours = picture.channels >= 3 ? 3 : 1;
    const bool hasAlpha = picture.channels == 2 || picture.channels == 4;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const float* from = picture.at(x, y);
            const float alpha = hasAlpha ? from[colours] : 1.f;
            for (int c = 0; c < 3; ++c)
                rgb.at(x, y)[c] = alpha * from[std::min(c, colours - 1)] + (1.f - alpha);
        }
    return rgb;
}

} // namespace patina
