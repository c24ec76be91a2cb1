#pragma once
// The rows of all maps that are being baked: a ring over the bands of the tile.

#include "export/bake.h"
#include "export/texel_sampler.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace patina {

/// The maps in the order of the files, `rows` rows of each: row y of the tile lies at y % rows.
class BakeRows {
  public:
    BakeRows(const LayerVolume& volume, const StackOptics& optics, const BakeOptions& options, int rows);

    const std::vector<MapInfo>& maps() const { return infos_; }
    int rows() const { return rows_; }

    /// Empties row y for a new band.
    void clearRow(int y);
    /// All maps but the normal.
    void put(int y, int x, const TexelValues& values);
    /// The same anew, but for visible(), which other rows may be reading.
    void replace(int y, int x, const TexelValues& values);
    /// The height alone of a texel that was put. \param height  scene units of the volume, as drawn
    void putHeight(int y, int x, double height);
    void putNormal(int y, int x, const Imath::V3f& encoded);
    void copyTexel(int toY, int toX, int fromY, int fromX);

    /// Height as exported, and whether anything has been put there since clearRow().
    float height(int y, int x) const { return height_[at(y, x)]; }
    bool isSet(int y, int x) const { return visible_[at(y, x)] != unset; }
    /// The outermost layer there, 0: the metal; 255 where nothing was put.
    std::uint8_t visible(int y, int x) const { return visible_[at(y, x)]; }
    /// Share of the texel's points at which the interface folds over, as far as they were asked.
    float fold(int y, int x) const { return fold_[at(y, x)]; }
    /// A fold that was found otherwise, 0…1.
    void putFold(int y, int x, float share);
    const void* row(int map, int y) const;

    /// Attributes known at the end, by map.
    std::vector<std::vector<std::pair<std::string, float>>> finalNumbers(const BakeSummary& summary) const;

    static constexpr std::uint8_t unset = 255;

  private:
    std::size_t at(int y, int x) const { return static_cast<std::size_t>(y % rows_) * size_ + x; }
    int add(const std::string& name, int channels, bool isColour, bool isHalf);
    void set(int map, std::size_t texel, double value);
    void set(int map, std::size_t texel, const Imath::V3d& value);

    int size_, rows_, layers_;
    double displacementScale_;
    std::vector<float> ids_;
    std::vector<MapInfo> infos_;
    std::vector<std::vector<float>> floats_;
    std::vector<std::vector<Imath::half>> halves_;
    std::vector<float> height_, fold_;
    std::vector<std::uint8_t> visible_;
    int displacement_, diffuse_, lobes_, baseColour_, metallic_, roughness_, normal_, thickness_;
    int materialId_ = -1, foldMask_ = -1, vectors_ = -1, fields_ = -1, fieldCount_ = 0;
};

} // namespace patina
