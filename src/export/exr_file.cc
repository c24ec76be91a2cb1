#include "export/exr_file.h"

#include "base/atomic_file.h"
#include "base/errors.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

namespace patina {

namespace {

std::vector<const char*> channelNames(int channels) {
    if (channels == 1)
        return {"Y"};
    return {"R", "G", "B"};
}

// SMPTE ST 2065-1 and S-2014-004: primaries AP1 and the white of ACES.
Imf::Chromaticities acescgChromaticities() {
    return {{0.713f, 0.293f}, {0.165f, 0.83f}, {0.128f, 0.044f}, {0.32168f, 0.33767f}};
}

} // namespace

void writeExr(const MapImage& map, const std::filesystem::path& path) {
    const bool isHalf = !map.halves.empty();
    const Imf::PixelType type = isHalf ? Imf::HALF : Imf::FLOAT;
    const std::size_t sampleBytes = isHalf ? sizeof(Imath::half) : sizeof(float);
    Imf::Header header(map.size, map.size);
    header.compression() = Imf::ZIP_COMPRESSION;
    header.zipCompressionLevel() = 1; // lossless like all levels; a third of the time of the usual 4, a few per cent larger
    const bool isAcescg = map.colourSpace == ColourSpace::acescg;
    header.insert("patina_colour_space",
                  Imf::StringAttribute(!map.isColour ? "data" : isAcescg ? "acescg" : "lin_rec709"));
    if (map.isColour)
        Imf::addChromaticities(header, isAcescg ? acescgChromaticities() : Imf::Chromaticities());
    for (const auto& [name, value] : map.texts)
        header.insert(name.c_str(), Imf::StringAttribute(value));
    for (const auto& [name, value] : map.numbers)
        header.insert(name.c_str(), Imf::FloatAttribute(value));

    const void* pixels = isHalf ? static_cast<const void*>(map.halves.data()) : map.floats.data();
    char* data = static_cast<char*>(const_cast<void*>(pixels)); // OpenEXR reads only, but asks for a char*
    Imf::FrameBuffer frame;
    std::size_t offset = 0;
    for (const char* name : channelNames(map.channels)) {
        header.channels().insert(name, Imf::Channel(type));
        frame.insert(
            name, Imf::Slice(type, data + offset, sampleBytes * map.channels, sampleBytes * map.channels * map.size));
        offset += sampleBytes;
    }
    AtomicFile file(path);
    try {
        Imf::OutputFile out(file.temporary().string().c_str(), header);
        out.setFrameBuffer(frame);
        out.writePixels(map.size);
    } catch (const std::exception& failure) {
        throw RunError(path.string(), fmt::format("cannot write the map: {}", failure.what()), "is the disk full?");
    }
    file.commit();
}

MapImage readExr(const std::filesystem::path& path) {
    MapImage map;
    map.name = path.stem().string();
    try {
        Imf::InputFile in(path.string().c_str());
        const Imf::Header& header = in.header();
        const Imath::Box2i window = header.dataWindow();
        map.size = window.max.x - window.min.x + 1;
        if (window.max.y - window.min.y + 1 != map.size || window.min != Imath::V2i(0))
            throw RunError(path.string(), "is not a square map");
        map.channels = header.channels().findChannel("Y") ? 1 : 3;
        const Imf::Channel* first = header.channels().findChannel(channelNames(map.channels)[0]);
        if (!first)
            throw RunError(path.string(), "has neither a channel Y nor channels R, G, B");
        const bool isHalf = first->type == Imf::HALF;
        const std::size_t count = static_cast<std::size_t>(map.size) * map.size * map.channels;
        char* data;
        if (isHalf) {
            map.halves.resize(count);
            data = reinterpret_cast<char*>(map.halves.data());
        } else {
            map.floats.resize(count);
            data = reinterpret_cast<char*>(map.floats.data());
        }
        const std::size_t sampleBytes = isHalf ? sizeof(Imath::half) : sizeof(float);
        Imf::FrameBuffer frame;
        std::size_t offset = 0;
        for (const char* name : channelNames(map.channels)) {
            frame.insert(name, Imf::Slice(isHalf ? Imf::HALF : Imf::FLOAT, data + offset, sampleBytes * map.channels,
                                          sampleBytes * map.channels * map.size));
            offset += sampleBytes;
        }
        in.setFrameBuffer(frame);
        in.readPixels(0, map.size - 1);
        for (auto item = header.begin(); item != header.end(); ++item) {
            if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&item.attribute()))
                map.texts.emplace_back(item.name(), text->value());
            else if (const auto* number = dynamic_cast<const Imf::FloatAttribute*>(&item.attribute()))
                map.numbers.emplace_back(item.name(), number->value());
            if (std::string(item.name()) == "chromaticities")
                map.isColour = true;
            const auto* text = dynamic_cast<const Imf::StringAttribute*>(&item.attribute());
            if (text && std::string(item.name()) == "patina_colour_space" && text->value() == "acescg")
                map.colourSpace = ColourSpace::acescg;
        }
    } catch (const Error&) {
        throw;
    } catch (const std::exception& failure) {
        throw RunError(path.string(), fmt::format("cannot be read: {}", failure.what()));
    }
    return map;
}

} // namespace patina
