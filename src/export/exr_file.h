#pragma once
// Maps as OpenEXR files: one map per file, channels Y or R, G, B, lossless.

#include "optics/colour.h"

#include <Imath/half.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace patina {

/// What a map is, without its pixels.
struct MapInfo {
    std::string name; ///< the file's stem: "displacement", "thickness_01_tarnish_1"
    int size = 0;
    int channels = 1;      ///< 1 (Y) or 3 (R, G, B)
    int udim = 0;          ///< number of its UV tile where there are several: the file is NAME.1001.exr; 0: NAME.exr
    bool isColour = false; ///< linear light of `colourSpace`; otherwise data
    bool isHalf = false;   ///< 16 bits a value instead of 32
    ColourSpace colourSpace = ColourSpace::rec709;
    std::vector<std::pair<std::string, std::string>> texts; ///< attributes of the file
    std::vector<std::pair<std::string, float>> numbers;     ///< attributes of the file

    std::string fileStem() const { return udim ? name + "." + std::to_string(udim) : name; }
    std::size_t pixelBytes() const { return static_cast<std::size_t>(channels) * (isHalf ? 2 : 4); }
};

/// A square map. Exactly one of `floats` and `halves` holds the pixels, interleaved, row 0 at the top.
struct MapImage : MapInfo {
    std::vector<float> floats;
    std::vector<Imath::half> halves;
};

/// A map written row by row, ZIP compressed, under a temporary name until commit().
class ExrWriter {
  public:
    /// \throws RunError as all of its functions do, naming the file
    ExrWriter(const MapInfo& map, const std::filesystem::path& path);
    ~ExrWriter();

    /// The next `count` rows, one after the other from `rows` on. Fastest where all but the last call have a multiple of
    /// 16 rows.
    void write(const void* rows, int count);
    /// When all rows are there.
    void finish();
    /// After finish(): new values of attributes that `map.numbers` named.
    void setNumbers(const std::vector<std::pair<std::string, float>>& numbers);
    /// Puts the finished file in its place.
    void commit();

    const std::filesystem::path& temporary() const;

  private:
    struct File;
    std::unique_ptr<File> file_;
};

/// The channels of a map's file: Y, or R, G, B.
std::vector<const char*> exrChannelNames(int channels);

/// Writes one map atomically. \throws RunError
void writeExr(const MapImage& map, const std::filesystem::path& path);

/// Reads a file that writeExr() wrote. \throws RunError
MapImage readExr(const std::filesystem::path& path);

} // namespace patina
