#pragma once
// ZIP compression of OpenEXR chunks by libdeflate.

#include <openexr.h>

namespace patina {

/// For `exr_encode_pipeline_t::compress_fn` of a file with ZIP compression: what OpenEXR makes of a chunk, byte for
/// byte another stream of the same samples, in less than half the time that its zlib takes (OpenEXR itself uses
/// libdeflate from 3.2 on). Lossless. `encoding_user_data` must be an ExrPacking.
exr_result_t packWithDeflate(exr_encode_pipeline_t* pipeline);

/// What a file's chunks are packed with, one after another.
class ExrPacking {
  public:
    ExrPacking();
    ~ExrPacking();
    ExrPacking(const ExrPacking&) = delete;
    ExrPacking& operator=(const ExrPacking&) = delete;

    exr_result_t pack(exr_encode_pipeline_t& pipeline);

  private:
    struct Buffers;
    Buffers* buffers_;
};

} // namespace patina
