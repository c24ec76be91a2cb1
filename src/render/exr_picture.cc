#include "render/exr_picture.h"

#include "base/atomic_file.h"
#include "base/errors.h"

#include <Imath/half.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <deque>

namespace patina {

namespace {

// The channels of a file, with the halves that they are written from.
class Channels {
  public:
    Channels(int width, int height) : header_(width, height), width_(width) {
        header_.compression() = Imf::ZIP_COMPRESSION;
        Imf::addChromaticities(header_, Imf::Chromaticities());
    }
    void add(const std::string& name, const Image& image, int channel, bool asHalf) {
        header_.channels().insert(name, Imf::Channel(asHalf ? Imf::HALF : Imf::FLOAT));
        const auto step = std::size_t(image.channels);
        if (!asHalf) {
            // OpenEXR reads only, but asks for a char*.
            auto* data = reinterpret_cast<char*>(const_cast<float*>(image.pixels.data() + channel));
            frame_.insert(
                name, Imf::Slice(Imf::FLOAT, data, step * sizeof(float), step * sizeof(float) * std::size_t(width_)));
            return;
        }
        std::vector<Imath::half>& halves = halves_.emplace_back();
        for (std::size_t i = std::size_t(channel); i < image.pixels.size(); i += step)
            halves.emplace_back(std::min(image.pixels[i], 65504.f));
        frame_.insert(name, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(halves.data()), sizeof(Imath::half),
                                       sizeof(Imath::half) * std::size_t(width_)));
    }
    Imf::Header& header() { return header_; }
    const Imf::FrameBuffer& frame() const { return frame_; }

  private:
    Imf::Header header_;
    Imf::FrameBuffer frame_;
    std::deque<std::vector<Imath::half>> halves_;
    int width_;
};

} // namespace

void writeExrPicture(const Image& light, const Features* features, const std::filesystem::path& path,
                     const ImageMetadata& metadata) {
    if (light.empty() || light.channels != 3)
        throw RunError(path.string(), "there is no picture to write");
    Channels channels(light.width, light.height);
    constexpr const char* rgb[] = {"R", "G", "B"};
    constexpr const char* xyz[] = {"X", "Y", "Z"};
    for (int c = 0; c < 3; ++c)
        channels.add(rgb[c], light, c, true);
    if (features) {
        if (features->alpha.width != light.width || features->alpha.height != light.height)
            throw RunError(path.string(), "the features are not of the picture's size");
        for (int c = 0; c < 3; ++c) {
            channels.add(std::string("albedo.") + rgb[c], features->albedo, c, true);
            channels.add(std::string("N.") + xyz[c], features->normal, c, true);
        }
        channels.add("A", features->alpha, 0, true);
        channels.add("Z", features->depth, 0, false);
        channels.add("material", features->material, 0, false);
        channels.add("thickness", features->thickness, 0, false);
    }
    for (const auto& [name, value] : metadata)
        channels.header().insert(name.c_str(), Imf::StringAttribute(value));
    AtomicFile file(path);
    try {
        Imf::OutputFile out(file.temporary().string().c_str(), channels.header());
        out.setFrameBuffer(channels.frame());
        out.writePixels(light.height);
    } catch (const std::exception& error) {
        throw RunError(path.string(), std::string("cannot be written: ") + error.what());
    }
    file.commit();
}

} // namespace patina
