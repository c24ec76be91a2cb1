#include "export/exr_file.h"

#include "base/errors.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

namespace patina {

std::vector<const char*> exrChannelNames(int channels) {
    if (channels == 1)
        return {"Y"};
    return {"R", "G", "B"};
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
        const Imf::Channel* first = header.channels().findChannel(exrChannelNames(map.channels)[0]);
        if (!first)
            throw RunError(path.string(), "has neither a channel Y nor channels R, G, B");
        const bool isHalf = map.isHalf = first->type == Imf::HALF;
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
        for (const char* name : exrChannelNames(map.channels)) {
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
