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
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>

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

struct ExrWriter::File {
    MapInfo map;
    std::filesystem::path path;
    AtomicFile atomic;
    // A stream of our own tells whether its last bytes have reached the disk; OpenEXR's does not.
    std::ofstream out;
    std::unique_ptr<Imf::StdOFStream> stream;
    std::unique_ptr<Imf::OutputFile> exr;
    int nextRow = 0;

    File(const MapInfo& map, const std::filesystem::path& path) : map(map), path(path), atomic(path) {}

    template <typename Work> void guarded(const Work& work) {
        try {
            work();
        } catch (const Error&) {
            throw;
        } catch (const std::exception& failure) {
            throw RunError(path.string(), fmt::format("cannot write the map: {}", failure.what()), "is the disk full?");
        }
    }
};

ExrWriter::ExrWriter(const MapInfo& map, const std::filesystem::path& path) : file_(new File(map, path)) {
    Imf::Header header(map.size, map.size);
    header.compression() = Imf::ZIP_COMPRESSION;
    // Lossless like all levels; a third of the time of the usual 4, a few per cent larger.
    header.zipCompressionLevel() = 1;
    const bool isAcescg = map.colourSpace == ColourSpace::acescg;
    header.insert("patina_colour_space",
                  Imf::StringAttribute(!map.isColour ? "data" : isAcescg ? "acescg" : "lin_rec709"));
    if (map.isColour)
        Imf::addChromaticities(header, isAcescg ? acescgChromaticities() : Imf::Chromaticities());
    for (const auto& [name, value] : map.texts)
        header.insert(name.c_str(), Imf::StringAttribute(value));
    for (const auto& [name, value] : map.numbers)
        header.insert(name.c_str(), Imf::FloatAttribute(value));
    for (const char* name : channelNames(map.channels))
        header.channels().insert(name, Imf::Channel(map.isHalf ? Imf::HALF : Imf::FLOAT));
    file_->guarded([&] {
        const std::string name = file_->atomic.temporary().string();
        file_->out.open(name, std::ios::binary | std::ios::trunc);
        file_->stream = std::make_unique<Imf::StdOFStream>(file_->out, name.c_str());
        file_->exr = std::make_unique<Imf::OutputFile>(*file_->stream, header, 0); // no threads of its own
    });
}

ExrWriter::~ExrWriter() = default;

void ExrWriter::write(const void* rows, int count) {
    const MapInfo& map = file_->map;
    const Imf::PixelType type = map.isHalf ? Imf::HALF : Imf::FLOAT;
    const std::size_t pixel = map.pixelBytes(), row = pixel * map.size, sample = map.isHalf ? 2 : 4;
    // OpenEXR reads only, but asks for a char*, and counts rows from the first of the image.
    char* data = static_cast<char*>(const_cast<void*>(rows)) - static_cast<std::ptrdiff_t>(row) * file_->nextRow;
    Imf::FrameBuffer frame;
    for (const char* name : channelNames(map.channels)) {
        frame.insert(name, Imf::Slice(type, data, pixel, row));
        data += sample;
    }
    file_->guarded([&] {
        file_->exr->setFrameBuffer(frame);
        file_->exr->writePixels(count);
    });
    file_->nextRow += count;
}

void ExrWriter::finish() {
    file_->guarded([&] {
        file_->exr.reset();
        file_->stream.reset();
        file_->out.flush();
        if (!file_->out)
            throw std::runtime_error("its end could not be written");
        file_->out.close();
    });
}

void ExrWriter::setNumbers(const std::vector<std::pair<std::string, float>>& numbers) {
    if (numbers.empty())
        return;
    file_->guarded([&] {
        // An attribute is its name, 0, its type, 0, the value's size and the value (openexr.com, file layout); the
        // header lies at the file's beginning.
        std::fstream file(file_->atomic.temporary(), std::ios::binary | std::ios::in | std::ios::out);
        std::string header(65536, '\0');
        file.read(header.data(), static_cast<std::streamsize>(header.size()));
        header.resize(static_cast<std::size_t>(file.gcount()));
        file.clear();
        for (const auto& [name, value] : numbers) {
            const std::string key = name + std::string("\0float\0\4\0\0\0", 11);
            const std::size_t at = header.find(key);
            if (at == std::string::npos)
                throw std::runtime_error("it has no attribute " + name);
            std::uint32_t bits;
            std::memcpy(&bits, &value, 4);
            char bytes[4];
            for (int i = 0; i < 4; ++i)
                bytes[i] = static_cast<char>(bits >> (8 * i) & 255u);
            file.seekp(static_cast<std::streamoff>(at + key.size()));
            file.write(bytes, 4);
        }
        file.flush();
        if (!file)
            throw std::runtime_error("its attributes could not be written");
    });
}

void ExrWriter::commit() { file_->atomic.commit(); }

const std::filesystem::path& ExrWriter::temporary() const { return file_->atomic.temporary(); }

void writeExr(const MapImage& map, const std::filesystem::path& path) {
    MapInfo info = map;
    info.isHalf = !map.halves.empty();
    ExrWriter writer(info, path);
    writer.write(info.isHalf ? static_cast<const void*>(map.halves.data()) : map.floats.data(), map.size);
    writer.finish();
    writer.commit();
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
