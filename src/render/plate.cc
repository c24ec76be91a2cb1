#include "render/plate.h"

#include "base/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

namespace patina {

namespace {

constexpr int most = 99;

// Sizes of rows or columns: first by what lies in one alone, then widened for what spans several.
class Tracks {
  public:
    Tracks(int count, int gap) : sizes_(std::size_t(count), 0), gap_(gap) {}

    void need(int first, int span, int size) {
        if (span == 1) {
            int& track = sizes_[std::size_t(first)];
            track = std::max(track, size);
            return;
        }
        const int missing = size - extent(first, span);
        for (int i = 0; i < span && missing > 0; ++i)
            sizes_[std::size_t(first + i)] += missing / span + (i < missing % span);
    }
    int start(int track) const { return std::accumulate(sizes_.begin(), sizes_.begin() + track, 0) + track * gap_; }
    int extent(int first, int span) const {
        return std::accumulate(sizes_.begin() + first, sizes_.begin() + first + span, 0) + (span - 1) * gap_;
    }
    int total() const { return extent(0, int(sizes_.size())); }

  private:
    std::vector<int> sizes_;
    int gap_;
};

void check(const std::vector<PlacedImage>& images) {
    if (images.empty())
        throw RunError("plate", "there are no pictures to put on it");
    std::set<std::pair<int, int>> taken;
    for (const PlacedImage& entry : images) {
        if (entry.picture.image.empty() || entry.picture.image.channels != 3)
            throw RunError("plate", "the picture '" + entry.picture.label + "' is empty or not RGB");
        if (entry.row < 0 || entry.column < 0 || entry.rows < 1 || entry.columns < 1 ||
            entry.row + entry.rows > most + 1 || entry.column + entry.columns > most + 1)
            throw RunError("plate", "the place of '" + entry.picture.label + "' is outside 0…99");
        for (int r = 0; r < entry.rows; ++r)
            for (int c = 0; c < entry.columns; ++c)
                if (!taken.insert({entry.row + r, entry.column + c}).second)
                    throw RunError("plate", fmt::format("row {}, column {} is taken by two pictures, one of them '{}'",
                                                        entry.row + r, entry.column + c, entry.picture.label));
    }
}

} // namespace

ContactSheet makePlate(const std::vector<PlacedImage>& images, const ContactSheetOptions& options) {
    check(images);
    int rowCount = 0, columnCount = 0, shortest = images.front().picture.image.height;
    for (const PlacedImage& entry : images) {
        rowCount = std::max(rowCount, entry.row + entry.rows);
        columnCount = std::max(columnCount, entry.column + entry.columns);
        shortest = std::min(shortest, entry.picture.image.height);
    }
    const int letters = options.labelHeight > 0 ? options.labelHeight : std::clamp(shortest / 16, 12, 28);
    const int gap = std::max(options.gap, 0);
    Tracks rows(rowCount, gap), columns(columnCount, gap);
    const auto heightOf = [&](const PlacedImage& entry) {
        return entry.picture.image.height + (entry.picture.label.empty() ? 0 : 2 * letters);
    };
    for (const bool alone : {true, false})
        for (const PlacedImage& entry : images) {
            if ((entry.rows == 1) == alone)
                rows.need(entry.row, entry.rows, heightOf(entry));
            if ((entry.columns == 1) == alone)
                columns.need(entry.column, entry.columns, entry.picture.image.width);
        }

    int titleBand = 0;
    ContactSheet sheet = makeEmptySheet(columns.total() + 2 * gap, rows.total() + 2 * gap, letters, options, titleBand);
    for (const PlacedImage& entry : images) {
        const Image& picture = entry.picture.image;
        const int width = columns.extent(entry.column, entry.columns), height = rows.extent(entry.row, entry.rows);
        const int left = gap + columns.start(entry.column) + (width - picture.width) / 2;
        const int top = titleBand + gap + rows.start(entry.row) + (height - heightOf(entry)) / 2;
        for (int y = 0; y < picture.height; ++y)
            std::copy_n(picture.at(0, y), std::size_t(picture.width) * 3, sheet.image.at(left, top + y));
        const bool drawn = drawText(sheet.image, entry.picture.label, float(left) + 0.5f * float(picture.width),
                                    float(top + picture.height) + 1.4f * float(letters), letters, options.ink,
                                    TextAlign::centre, float(std::max(width, picture.width)));
        sheet.hasText = sheet.hasText && drawn;
    }
    return sheet;
}

} // namespace patina
