#include "export/bake.h"

#include "export/bake_rows.h"
#include "export/seam_heights.h"
#include "export/texel_map.h"
#include "export/texel_sampler.h"
#include "optics/colour.h"
#include "surface/surface_walk.h"
#include "surface/uv_frame.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

namespace patina {

using Imath::V2i;
using Imath::V3d;
using Imath::V3f;

namespace {

// A multiple of the 16 rows that EXR's ZIP packs together, and as many as the widest gutter.
constexpr int bandRows = 32;
// A band's stages, in order: texels are read, refined, get their normals, gutters, and go out. Refining, normals and
// gutters look into the bands beside theirs, so that each stage is two bands behind the one before; then all of them can
// go side by side.
constexpr int refineDelay = 2, normalDelay = 4, gutterDelay = 6, writeDelay = 7;
// Gutters still copy from the band that goes out.
constexpr int bandsHeld = writeDelay + 1;

// Per row, then over the rows in order: the sums do not depend on the threads.
struct RowSums {
    std::size_t covered = 0, supersampled = 0, green = 0;
    double points = 0.0, unreadable = 0.0, foldsAsked = 0.0, folds = 0.0; // of folds: texels
    double baseOffset = 0.0, baseOffset2 = 0.0;                           // of points
    float maxDisplacement = 0.f;
    V3d colour{0.0};
};

/// One tile, band by band.
class TileBake {
  public:
    TileBake(const SurfaceWalk& walk, const TexelSampler& sampler, const TangentFrames& frames,
             const BakeOptions& options, const std::vector<std::uint8_t>& pointsAcross, ColourSpace space,
             double heightUnits, const SeamHeights& seams, std::size_t tile, TexelMap texels, BakeRows& rows)
        : surface_(walk.surface()), sampler_(sampler), frames_(frames), options_(options), across_(pointsAcross),
          space_(space), heightUnits_(heightUnits), seams_(seams), tile_(tile), texels_(std::move(texels)), rows_(rows),
          sums_(options.resolution), supersampled_(static_cast<std::size_t>(options.resolution) * rows.rows()) {}

    void run(MapSink& sink, Progress& progress, double done, double share) {
        const int size = texels_.size, bands = (size + bandRows - 1) / bandRows;
        const int maps = static_cast<int>(rows_.maps().size());
        for (int band = 0; band < bands + writeDelay; ++band) {
            progress.checkpoint();
            const int toWrite = (band - writeDelay) * bandRows;
            tbb::parallel_for(
                0, maps + 4 * bandRows,
                [&](int i) {
                    if (i < maps) {
                        if (toWrite >= 0)
                            sink.write(i, rows_.row(i, toWrite), std::min(bandRows, size - toWrite));
                        return;
                    }
                    const int stage = (i - maps) / bandRows, row = (i - maps) % bandRows;
                    if (stage == 0)
                        rowOf(band, row, [&](int y) { readRow(y); });
                    else if (stage == 1)
                        rowOf(band - refineDelay, row, [&](int y) { refineRow(y); });
                    else if (stage == 2)
                        rowOf(band - normalDelay, row, [&](int y) { normalRow(y); });
                    else
                        rowOf(band - gutterDelay, row, [&](int y) { gutterRow(y); });
                },
                tbb::simple_partitioner());
            progress.update(done + share * (band + 1) / (bands + writeDelay));
        }
    }

    const TexelMap& texels() const { return texels_; }
    const std::vector<RowSums>& sums() const { return sums_; }

  private:
    struct Work {
        TexelSampler::Scratch scratch;
        TexelValues values;
    };

    // Row `row` of a band, if there is one.
    template <typename Use>
    void rowOf(int band, int row, const Use& use) {
        const int y = band * bandRows + row;
        if (band >= 0 && y < texels_.size)
            use(y);
    }
    const SurfacePoint& pointOf(int y, int x) const {
        return texels_.points[static_cast<std::size_t>(y) * texels_.size + x];
    }
    template <typename List, typename Key>
    static auto firstFrom(const List& list, std::size_t texel, const Key& key) {
        return std::lower_bound(list.begin(), list.end(), texel,
                                [&](const auto& item, std::size_t value) { return key(item) < value; });
    }
    template <typename Use>
    void eachRimTexel(int y, const Use& use) const {
        const std::size_t start = static_cast<std::size_t>(y) * texels_.size;
        for (auto rim = firstFrom(texels_.rim, start, [](const RimTexel& r) { return r.texel; });
             rim != texels_.rim.end() && rim->texel < start + texels_.size; ++rim)
            use(static_cast<int>(rim->texel - start), *rim);
    }

    // Without the mask one texel of sixteen tells the fraction.
    bool asksFolds(int y, int x) const { return options_.foldMask || (x % 4 == 0 && y % 4 == 0); }

    void readRow(int y) {
        Work& work = work_.local();
        rows_.clearRow(y);
        const std::size_t ring = static_cast<std::size_t>(y % rows_.rows()) * texels_.size;
        std::fill_n(supersampled_.begin() + ring, texels_.size, std::uint8_t(0));
        RowSums& sums = sums_[y];
        for (int x = 0; x < texels_.size; ++x) {
            const SurfacePoint& point = pointOf(y, x);
            if (point.triangle < 0)
                continue;
            const int across = across_[point.triangle];
            supersampled_[ring + x] = across > 1;
            sampler_.read(point, across, asksFolds(y, x), work.scratch, work.values);
            putInSpace(point, work.values);
            rows_.put(y, x, work.values);
            count(work.values, sums);
        }
        eachRimTexel(y, [&](int x, const RimTexel& rim) {
            sampler_.read(rim.shown, across_[rim.shown.triangle], options_.foldMask, work.scratch, work.values);
            putInSpace(rim.border, work.values);
            rows_.put(y, x, work.values);
        });
        seamRow(y);
    }

    // Both sides of a seam show one height.
    void seamRow(int y) {
        seams_.eachOfRow(tile_, y, [&](int x, double height, bool) { rows_.putHeight(y, x, height); });
    }

    // Texels beside a chart are read in the chart's frame.
    void putInSpace(const SurfacePoint& owner, TexelValues& values) const {
        if (options_.vectorDisplacement && options_.vectorSpace != VectorSpace::object)
            values.vector =
                toSpace(options_.vectorSpace, frames_.interpolatedAt(owner, normalAt(surface_, owner)), values.vector);
    }

    void count(const TexelValues& values, RowSums& sums) const {
        ++sums.covered;
        sums.points += values.points;
        sums.unreadable += values.unreadable;
        sums.baseOffset = std::max(sums.baseOffset, values.baseOffset);
        sums.baseOffset2 += values.baseOffset2;
        const V3d xyz = xyzFromLinear(values.baseColour, space_);
        sums.colour += linearRec709FromXyz(xyz);
        sums.green += labFromXyz(xyz).y < -4.0;
    }

    // Texels read at one point whose neighbours show another layer are read again at four.
    void refineRow(int y) {
        Work& work = work_.local();
        const std::size_t ring = static_cast<std::size_t>(y % rows_.rows()) * texels_.size;
        const int size = texels_.size;
        for (int x = 0; x < size; ++x) {
            const SurfacePoint& point = pointOf(y, x);
            if (point.triangle < 0)
                continue;
            if (supersampled_[ring + x]) {
                ++sums_[y].supersampled;
                continue;
            }
            bool differs = false;
            const std::uint8_t own = rows_.visible(y, x);
            for (int ny = std::max(0, y - 1); ny <= std::min(size - 1, y + 1) && !differs; ++ny)
                for (int nx = std::max(0, x - 1); nx <= std::min(size - 1, x + 1); ++nx)
                    differs = differs || (rows_.isSet(ny, nx) && rows_.visible(ny, nx) != own);
            if (!differs)
                continue;
            ++sums_[y].supersampled;
            sampler_.read(point, 2, options_.foldMask, work.scratch, work.values);
            putInSpace(point, work.values);
            rows_.replace(y, x, work.values);
        }
        seamRow(y);
    }

    // The normal of the displaced surface P + h N, from its derivatives by u and v, in the frame of the tangents.
    // \return whether the heights say nothing: beside the texel normals cross before they end, as in creases that are
    // narrower than the layers, and neighbours lie in the wrong order; or they end on different sheets.
    bool normalAtTexel(int y, int x, const SurfacePoint& shown, const SurfacePoint& owner) {
        const UvDerivatives uv = uvDerivativesOf(surface_, owner.triangle);
        V3d encoded(0.5, 0.5, 1.0);
        bool turned = false;
        if (uv.valid) {
            const V3d normal = normalAt(surface_, shown);
            const double height = rows_.height(y, x) / heightUnits_;
            // The facets' own slope is no relief: the derivatives of the surface that the smooth normals stand for.
            const auto derivative = [&](const V3d& along, const V3d& normalChange, double slope) {
                const V3d flat = along - normal * along.dot(normal);
                const V3d turned = normalChange - normal * normalChange.dot(normal);
                return flat + turned * height + normal * (slope / heightUnits_);
            };
            // Rows run against v.
            const V3d du = derivative(uv.du, uv.normalDu, slopeAlong(y, x, 0, 1));
            const V3d dv = derivative(uv.dv, uv.normalDv, -slopeAlong(y, x, 1, 0));
            V3d displaced = du.cross(dv);
            if (uv.mirrored)
                displaced = -displaced;
            const double length = displaced.length();
            turned = displaced.dot(normal) < 0.0 || isWall(y, x, uv);
            if (length > 0.0 && displaced.dot(normal) > 0.0) {
                displaced /= length;
                const TangentFrames::Frame frame = frames_.at(owner, normal);
                encoded =
                    V3d(displaced.dot(frame.tangent), displaced.dot(frame.bitangent), displaced.dot(normal)) * 0.5 +
                    V3d(0.5);
            }
        }
        rows_.putNormal(y, x, V3f(encoded));
        return turned;
    }

    // Whether the height jumps to a neighbour.
    bool isWall(int y, int x, const UvDerivatives& uv) const {
        const double own = rows_.height(y, x);
        const auto jumps = [&](int ny, int nx, const V3d& along) {
            return isSet(ny, nx) && std::abs(rows_.height(ny, nx) - own) >
                                        wallHeight(along.length() / texels_.size, sampler_.voxelSize()) * heightUnits_;
        };
        return jumps(y, x - 1, uv.du) || jumps(y, x + 1, uv.du) || jumps(y - 1, x, uv.dv) || jumps(y + 1, x, uv.dv);
    }

    bool isSet(int y, int x) const {
        return y >= 0 && x >= 0 && y < texels_.size && x < texels_.size && rows_.isSet(y, x);
    }

    // How the height changes over the width of the tile along a row or a column.
    double slopeAlong(int y, int x, int dy, int dx) const {
        const bool ahead = isSet(y + dy, x + dx), behind = isSet(y - dy, x - dx);
        const double after = rows_.height(ahead ? y + dy : y, ahead ? x + dx : x);
        const double before = rows_.height(behind ? y - dy : y, behind ? x - dx : x);
        return ahead || behind ? (after - before) * texels_.size / (int(ahead) + int(behind)) : 0.0;
    }

    void normalRow(int y) {
        seams_.eachOfRow(tile_, y, [&](int x, double, bool open) {
            if (open)
                rows_.putFold(y, x, 1.f);
        });
        for (int x = 0; x < texels_.size; ++x)
            if (const SurfacePoint& point = pointOf(y, x); point.triangle >= 0) {
                if (normalAtTexel(y, x, point, point))
                    rows_.putFold(y, x, 1.f);
                RowSums& sums = sums_[y];
                sums.maxDisplacement = std::max(sums.maxDisplacement, std::abs(rows_.height(y, x)));
                if (asksFolds(y, x)) {
                    sums.foldsAsked += 1.0;
                    sums.folds += rows_.fold(y, x);
                }
            }
        eachRimTexel(y, [&](int x, const RimTexel& rim) {
            if (normalAtTexel(y, x, rim.shown, rim.border))
                rows_.putFold(y, x, 1.f);
        });
    }

    void gutterRow(int y) {
        const std::size_t start = static_cast<std::size_t>(y) * texels_.size;
        for (auto copy = firstFrom(texels_.gutter, start, [](const auto& pair) { return pair.first; });
             copy != texels_.gutter.end() && copy->first < start + texels_.size; ++copy)
            rows_.copyTexel(y, static_cast<int>(copy->first - start), static_cast<int>(copy->second / texels_.size),
                            static_cast<int>(copy->second % texels_.size));
    }

    const SurfaceMesh& surface_;
    const TexelSampler& sampler_;
    const TangentFrames& frames_;
    const BakeOptions& options_;
    const std::vector<std::uint8_t>& across_;
    ColourSpace space_;
    double heightUnits_; // of the maps' heights per scene unit of the volume
    const SeamHeights& seams_;
    std::size_t tile_;
    TexelMap texels_;
    BakeRows& rows_;
    std::vector<RowSums> sums_;
    std::vector<std::uint8_t> supersampled_;
    tbb::enumerable_thread_specific<Work> work_;
};

// Keeps what it is given.
class MemorySink : public MapSink {
  public:
    std::vector<MapImage> maps;

    void begin(const std::vector<MapInfo>& infos) override {
        first_ = maps.size();
        filled_.assign(infos.size(), 0);
        for (const MapInfo& info : infos) {
            MapImage& map = maps.emplace_back();
            static_cast<MapInfo&>(map) = info;
            const std::size_t values = static_cast<std::size_t>(info.size) * info.size * info.channels;
            info.isHalf ? map.halves.resize(values) : map.floats.resize(values);
        }
    }
    void write(int m, const void* rows, int count) override {
        MapImage& map = maps[first_ + m];
        const std::size_t rowBytes = map.pixelBytes() * map.size;
        char* pixels =
            map.isHalf ? reinterpret_cast<char*>(map.halves.data()) : reinterpret_cast<char*>(map.floats.data());
        std::memcpy(pixels + rowBytes * filled_[m], rows, rowBytes * count);
        filled_[m] += count;
    }
    void end() override {}
    void finish(const std::vector<std::vector<std::pair<std::string, float>>>& numbers) override {
        for (std::size_t i = 0; i < maps.size(); ++i)
            for (const auto& [name, value] : numbers[i % numbers.size()])
                for (auto& [known, number] : maps[i].numbers)
                    if (known == name)
                        number = value;
    }

  private:
    std::size_t first_ = 0;
    std::vector<int> filled_;
};

} // namespace

const MapImage* MapSet::find(const std::string& name) const {
    for (const MapImage& map : maps)
        if (map.name == name)
            return &map;
    return nullptr;
}

BakeSummary bakeInto(MapSink& sink, const LayerVolume& volume, const SurfaceMesh& surface, const StackOptics& optics,
                     const BakeOptions& given, Progress& progress) {
    BakeOptions options = given;
    options.gutter = std::clamp(options.gutter, 0, bandRows);
    BakeSummary summary;
    summary.tiles = uvTiles(surface);
    const SurfaceWalk walk(surface);
    const TangentFrames frames(surface);
    const TexelSampler sampler(volume, walk, optics, options);
    std::vector<std::uint8_t> across(surface.triangles.size());
    tbb::parallel_for(std::size_t(0), across.size(), [&](std::size_t t) {
        across[t] = static_cast<std::uint8_t>(sampler.pointsAcross(static_cast<int>(t)));
    });
    progress.checkpoint();

    BakeRows rows(volume, optics, options, bandRows * bandsHeld);
    const ColourSpace space = optics.features().colourSpace;
    const double heightUnits =
        options.displacementUnits * (options.keepExaggeration ? 1.0 : 1.0 / volume.scale().exaggeration);
    RowSums sums;
    std::size_t overlapping = 0;
    TexelMap map =
        makeTexelMap(walk, options.resolution, options.gutter, summary.tiles.empty() ? V2i(0, 0) : summary.tiles[0]);
    const SeamHeights seams(walk, sampler, across, summary.tiles, map, options.gutter);
    progress.checkpoint();
    for (std::size_t i = 0; i < summary.tiles.size(); ++i) {
        if (i > 0)
            map = makeTexelMap(walk, options.resolution, options.gutter, summary.tiles[i]);
        TileBake tile(walk, sampler, frames, options, across, space, heightUnits, seams, i, std::move(map), rows);
        progress.checkpoint();
        std::vector<MapInfo> maps = rows.maps();
        if (summary.tiles.size() > 1)
            for (MapInfo& map : maps)
                map.udim = udimOf(summary.tiles[i]);
        sink.begin(maps);
        const double share = 1.0 / static_cast<double>(summary.tiles.size());
        tile.run(sink, progress, share * static_cast<double>(i), share);
        sink.end();
        for (const RowSums& row : tile.sums()) {
            sums.covered += row.covered;
            sums.supersampled += row.supersampled;
            sums.green += row.green;
            sums.points += row.points;
            sums.unreadable += row.unreadable;
            sums.baseOffset = std::max(sums.baseOffset, row.baseOffset);
            sums.baseOffset2 += row.baseOffset2;
            sums.foldsAsked += row.foldsAsked;
            sums.folds += row.folds;
            sums.colour += row.colour;
            sums.maxDisplacement = std::max(sums.maxDisplacement, row.maxDisplacement);
        }
        if (overlapping == 0)
            summary.overlappingFaces = tile.texels().overlappingFaces;
        overlapping += tile.texels().overlapping;
    }
    const double texels = static_cast<double>(std::max<std::size_t>(1, sums.covered));
    summary.texels = sums.covered;
    summary.coveredFraction =
        static_cast<double>(sums.covered) / (static_cast<double>(options.resolution) * options.resolution *
                                             static_cast<double>(std::max<std::size_t>(1, summary.tiles.size())));
    summary.unreadableFraction = sums.unreadable / std::max(1.0, sums.points);
    summary.voxelisationRms = std::sqrt(sums.baseOffset2 / std::max(1.0, sums.points));
    summary.voxelisationMax = sums.baseOffset;
    summary.supersampledFraction = static_cast<double>(sums.supersampled) / texels;
    summary.greenFraction = static_cast<double>(sums.green) / texels;
    summary.foldFraction = sums.folds / std::max(1.0, sums.foldsAsked);
    summary.overlapFraction = static_cast<double>(overlapping) / texels;
    summary.meanColour = sums.colour / texels;
    summary.maxDisplacement = sums.maxDisplacement;
    sink.finish(rows.finalNumbers(summary));
    return summary;
}

MapSet bake(const LayerVolume& volume, const SurfaceMesh& surface, const StackOptics& optics,
            const BakeOptions& options, Progress& progress) {
    MemorySink sink;
    MapSet set;
    set.summary = bakeInto(sink, volume, surface, optics, options, progress);
    set.maps = std::move(sink.maps);
    return set;
}

} // namespace patina
