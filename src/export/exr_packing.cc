#include "export/exr_packing.h"

#include <libdeflate.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

namespace patina {

namespace {

// Lossless like all levels; the files are a few per cent larger than at zlib's usual one.
constexpr int level = 1;

struct FreeCompressor {
    void operator()(libdeflate_compressor* compressor) const { libdeflate_free_compressor(compressor); }
};

} // namespace

struct ExrPacking::Buffers {
    std::unique_ptr<libdeflate_compressor, FreeCompressor> compressor{libdeflate_alloc_compressor(level)};
    std::vector<std::uint8_t> split, differences, packed;
};

ExrPacking::ExrPacking() : buffers_(new Buffers) {}
ExrPacking::~ExrPacking() = default;

exr_result_t ExrPacking::pack(exr_encode_pipeline_t& pipeline) {
    const auto bytes = static_cast<std::size_t>(pipeline.packed_bytes);
    const auto* samples = static_cast<const std::uint8_t*>(pipeline.packed_buffer);
    Buffers& b = *buffers_;
    if (!b.compressor)
        return EXR_ERR_OUT_OF_MEMORY;
    // The format's predictor: even bytes before odd ones, then each as its difference from the one before, plus 128.
    const std::size_t half = (bytes + 1) / 2;
    b.split.resize(bytes);
    b.differences.resize(bytes);
    std::uint8_t *even = b.split.data(), *odd = even + half;
    for (std::size_t i = 0; i < bytes / 2; ++i) {
        even[i] = samples[2 * i];
        odd[i] = samples[2 * i + 1];
    }
    if (bytes % 2 != 0)
        even[half - 1] = samples[bytes - 1];
    const std::uint8_t* split = b.split.data();
    std::uint8_t* differences = b.differences.data();
    if (bytes > 0)
        differences[0] = split[0];
    for (std::size_t i = 1; i < bytes; ++i)
        differences[i] = static_cast<std::uint8_t>(split[i] - split[i - 1] + 128);
    b.packed.resize(bytes);
    std::size_t size =
        bytes > 0 ? libdeflate_zlib_compress(b.compressor.get(), differences, bytes, b.packed.data(), bytes) : 0;
    // Where nothing is gained (0: it did not fit) readers expect the samples as they are.
    if (size == 0 || size >= bytes) {
        std::memcpy(b.packed.data(), samples, bytes);
        size = bytes;
    }
    pipeline.compressed_buffer = b.packed.data();
    pipeline.compressed_alloc_size = 0; // ours
    pipeline.compressed_bytes = size;
    return EXR_ERR_SUCCESS;
}

exr_result_t packWithDeflate(exr_encode_pipeline_t* pipeline) {
    return static_cast<ExrPacking*>(pipeline->encoding_user_data)->pack(*pipeline);
}

} // namespace patina
