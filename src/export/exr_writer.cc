#include "base/atomic_file.h"
#include "base/errors.h"
#include "export/exr_file.h"
#include "export/exr_packing.h"

#include <fmt/format.h>
#include <openexr.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace patina {

namespace {

constexpr int chunkRows = 16; // of ZIP compression

// SMPTE ST 2065-1 and S-2014-004: primaries AP1 and the white of ACES.
constexpr exr_attr_chromaticities_t acescg = {0.713f, 0.293f, 0.165f, 0.83f, 0.128f, 0.044f, 0.32168f, 0.33767f};
// ITU-R BT.709-6, table 1.
constexpr exr_attr_chromaticities_t rec709 = {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};

// Errors are thrown with their code's text; OpenEXR would print them besides.
void saySilently(exr_const_context_t, exr_result_t, const char*) {}

void check(exr_result_t result) {
    if (result != EXR_ERR_SUCCESS)
        throw std::runtime_error(exr_get_error_code_as_string(result));
}

} // namespace

struct ExrWriter::File {
    MapInfo map;
    std::filesystem::path path;
    AtomicFile atomic;
    exr_context_t context = nullptr;
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    bool hasPipeline = false;
    ExrPacking packing;
    std::vector<char> waiting; // rows that do not fill a chunk yet
    int written = 0;           // rows

    File(const MapInfo& map, const std::filesystem::path& path) : map(map), path(path), atomic(path) {}
    ~File() { close(); }

    template <typename Work>
    void guarded(const Work& work) {
        try {
            work();
        } catch (const Error&) {
            throw;
        } catch (const std::exception& failure) {
            throw RunError(path.string(), fmt::format("cannot write the map: {}", failure.what()), "is the disk full?");
        }
    }

    std::size_t rowBytes() const { return map.pixelBytes() * static_cast<std::size_t>(map.size); }

    void begin() {
        exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
        options.error_handler_fn = saySilently;
        check(exr_start_write(&context, atomic.temporary().c_str(), EXR_WRITE_FILE_DIRECTLY, &options));
        int part = 0;
        check(exr_add_part(context, map.name.c_str(), EXR_STORAGE_SCANLINE, &part));
        check(exr_set_longname_support(context, 1));
        check(exr_initialize_required_attr_simple(context, part, map.size, map.size, EXR_COMPRESSION_ZIP));
        const bool isAcescg = map.colourSpace == ColourSpace::acescg;
        check(exr_attr_set_string(context, part, "patina_colour_space",
                                  !map.isColour ? "data"
                                  : isAcescg    ? "acescg"
                                                : "lin_rec709"));
        if (map.isColour)
            check(exr_attr_set_chromaticities(context, part, "chromaticities", isAcescg ? &acescg : &rec709));
        for (const auto& [name, value] : map.texts)
            check(exr_attr_set_string(context, part, name.c_str(), value.c_str()));
        for (const auto& [name, value] : map.numbers)
            check(exr_attr_set_float(context, part, name.c_str(), value));
        for (const char* name : exrChannelNames(map.channels))
            check(exr_add_channel(context, part, name, map.isHalf ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT,
                                  EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
        check(exr_write_header(context));
    }

    // At most chunkRows rows.
    void writeChunk(const char* rows) {
        exr_chunk_info_t chunk;
        check(exr_write_scanline_chunk_info(context, 0, written, &chunk));
        check(hasPipeline ? exr_encoding_update(context, 0, &chunk, &pipeline)
                          : exr_encoding_initialize(context, 0, &chunk, &pipeline));
        const std::vector<const char*> names = exrChannelNames(map.channels);
        const int sample = map.isHalf ? 2 : 4;
        for (int c = 0; c < pipeline.channel_count; ++c) {
            exr_coding_channel_info_t& channel = pipeline.channels[c];
            const auto place = std::find_if(names.begin(), names.end(), [&](const char* name) {
                return std::strcmp(name, channel.channel_name) == 0;
            });
            channel.encode_from_ptr = reinterpret_cast<const std::uint8_t*>(rows) + sample * (place - names.begin());
            channel.user_pixel_stride = static_cast<int32_t>(map.pixelBytes());
            channel.user_line_stride = static_cast<int32_t>(rowBytes());
            channel.user_bytes_per_element = static_cast<std::int16_t>(sample);
            channel.user_data_type = channel.data_type;
        }
        if (!hasPipeline) {
            check(exr_encoding_choose_default_routines(context, 0, &pipeline));
            pipeline.compress_fn = packWithDeflate;
            pipeline.encoding_user_data = &packing;
            hasPipeline = true;
        }
        check(exr_encoding_run(context, 0, &pipeline));
        written += std::min(chunkRows, map.size - written);
    }

    void finish() {
        if (written != map.size)
            throw std::runtime_error("rows are missing");
        check(close());
    }

    exr_result_t close() {
        if (hasPipeline) {
            pipeline.compressed_buffer = nullptr; // ours
            exr_encoding_destroy(context, &pipeline);
            hasPipeline = false;
        }
        return context ? exr_finish(&context) : EXR_ERR_SUCCESS;
    }
};

ExrWriter::ExrWriter(const MapInfo& map, const std::filesystem::path& path) : file_(new File(map, path)) {
    file_->guarded([&] { file_->begin(); });
}

ExrWriter::~ExrWriter() = default;

void ExrWriter::write(const void* rows, int count) {
    const auto* next = static_cast<const char*>(rows);
    const std::size_t row = file_->rowBytes();
    std::vector<char>& waiting = file_->waiting;
    file_->guarded([&] {
        while (count > 0) {
            const int held = static_cast<int>(waiting.size() / row);
            const int chunk = std::min(chunkRows, file_->map.size - file_->written);
            if (chunk == 0)
                throw std::runtime_error("there are more rows than the map has");
            const int taken = std::min(count, chunk - held);
            if (taken == chunk) {
                file_->writeChunk(next);
            } else {
                waiting.insert(waiting.end(), next, next + row * static_cast<std::size_t>(taken));
                if (held + taken == chunk) {
                    file_->writeChunk(waiting.data());
                    waiting.clear();
                }
            }
            next += row * static_cast<std::size_t>(taken);
            count -= taken;
        }
    });
}

void ExrWriter::finish() {
    file_->guarded([&] { file_->finish(); });
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

void ExrWriter::commit() {
    file_->atomic.commit();
}

const std::filesystem::path& ExrWriter::temporary() const {
    return file_->atomic.temporary();
}

void writeExr(const MapImage& map, const std::filesystem::path& path) {
    MapInfo info = map;
    info.isHalf = !map.halves.empty();
    ExrWriter writer(info, path);
    writer.write(info.isHalf ? static_cast<const void*>(map.halves.data()) : map.floats.data(), map.size);
    writer.finish();
    writer.commit();
}

} // namespace patina
