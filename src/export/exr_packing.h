#pragma once
// ZIP compression of OpenEXR chunks by libdeflate.

#include <openexr.h>

#include <memory>

namespace patina {

/// For `exr_encode_pipeline_t::compress_fn` of a file with ZIP compression: another stream of the same samples as
/// OpenEXR's, in about six tenths of the time of zlib's fastest level (OpenEXR itself uses libdeflate from 3.2 on).
/// Lossless. `encoding_user_data` must be an ExrPacking.
exr_result_t packWithDeflate(exr_encode_pipeline_t* pipeline);

/// What a file's chunks are packed with, one after another.
class ExrPacking {
  public:
    ExrPacking();
    ~ExrPacking();

    exr_result_t pack(exr_encode_pipeline_t& pipeline);

  private:
    struct Buffers;
    std::unique_ptr<Buffers> buffers_;
};

} // namespace patina
