#include "render/contact_sheet.h"

#include "base/errors.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace patina {

namespace {

// OpenImageIO searches the folders of the system for a name; Debian's fonts-dejavu-core is what setup installs.
const char* const fontNames[] = {"DejaVuSans", "LiberationSans-Regular", "FreeSans", "NotoSans-Regular"};
const char* const fontFolders[] = {"/usr/share/fonts/truetype/dejavu",      "/usr/share/fonts/truetype/liberation",
                                   "/usr/share/fonts/truetype/liberation2", "/usr/share/fonts/truetype/freefont",
                                   "/usr/share/fonts/truetype/noto",        "/usr/share/fonts/TTF"};

std::string findFont() {
    std::error_code ignored;
    for (const char* name : fontNames)
        for (const char* folder : fontFolders) {
            const auto path = std::filesystem::path(folder) / (std::string(name) + ".ttf");
            if (std::filesystem::exists(path, ignored))
                return path.string();
        }
    return {};
}

void paste(Image& sheet, const Image& picture, int left, int top) {
    for (int y = 0; y < picture.height; ++y)
        std::copy_n(picture.at(0, y), std::size_t(picture.width) * 3, sheet.at(left, top + y));
}

// OpenImageIO 2.4 loses the upper bits of characters of two bytes: "µm" would read "5m". A µ is drawn as a u whose left
// stem goes on below the line. \returns where they are
std::vector<std::size_t> replaceMu(std::string& text) {
    std::vector<std::size_t> places;
    for (std::size_t at; (at = text.find("µ")) != std::string::npos;) {
        text.replace(at, 2, "u");
        places.push_back(at);
    }
    return places;
}

// Continues the stem of the u at `place` of a line whose ink begins at `left`, as the font itself draws it: its
// coverage is read off a copy of the line in white on black.
void drawStem(Image& image, const std::string& text, std::size_t place, int left, int baseline, int height,
              const std::string& font, const Imath::V3f& ink) {
    const OIIO::ROI before = OIIO::ImageBufAlgo::text_size(text.substr(0, place + 1), height, font);
    const OIIO::ROI letter = OIIO::ImageBufAlgo::text_size("u", height, font);
    Image line(before.width() + 2 * height, 3 * height, 1);
    OIIO::ImageBuf buffer(OIIO::ImageSpec(line.width, line.height, 1, OIIO::TypeDesc::FLOAT), line.pixels.data());
    const float white = 1.f;
    OIIO::ImageBufAlgo::render_text(buffer, 2, 2 * height, text, height, font, OIIO::cspan<float>(&white, 1));
    const int from = 2 + before.width() - letter.width(), row = 2 * height - std::max(1, height / 4);
    const int drop = std::max(2, int(std::lround(0.21 * height)));
    for (int x = std::max(0, from - 1); x < std::min(line.width, from + (letter.width() + 1) / 2); ++x) {
        const float cover = std::clamp(line.at(x, row)[0], 0.f, 1.f);
        const int column = left + x - 2;
        for (int y = std::max(0, baseline); y < std::min(image.height, baseline + drop); ++y)
            if (column >= 0 && column < image.width)
                image.setRgb(column, y, image.rgb(column, y) + (ink - image.rgb(column, y)) * cover);
    }
}

} // namespace

bool drawText(Image& image, const std::string& words, float x, float y, int height, const Imath::V3f& ink,
              TextAlign align, float maxWidth) {
    if (words.empty())
        return true;
    std::string text = words;
    std::vector<std::size_t> mus = replaceMu(text);
    const std::string font = findFont();
    if (font.empty())
        return false;
    OIIO::ROI size = OIIO::ImageBufAlgo::text_size(text, height, font);
    if (!size.defined())
        return false;
    if (maxWidth > 0.f && float(size.width()) > maxWidth) {
        const int least = height / 2;
        height = std::max(least, int(float(height) * maxWidth / float(size.width())));
        size = OIIO::ImageBufAlgo::text_size(text, height, font);
        for (; height > least && float(size.width()) > maxWidth; --height) // widths are rounded letter by letter
            size = OIIO::ImageBufAlgo::text_size(text, height - 1, font);
        // Still too long: its last words go.
        for (std::string kept = words; float(size.width()) > maxWidth && kept.find_last_of(' ') != std::string::npos;) {
            kept.erase(kept.find_last_of(' '));
            text = kept + " ...";
            mus = replaceMu(text);
            size = OIIO::ImageBufAlgo::text_size(text, height, font);
        }
    }
    const float shift = align == TextAlign::left ? 0.f : align == TextAlign::centre ? 0.5f : 1.f;
    const int left = int(std::lround(x - shift * float(size.width()))), baseline = int(std::lround(y));
    // Drawn on a line of its own and then laid over the picture: what would lie outside the picture OpenImageIO ends
    // the program for.
    Image line(size.width() + 2 * height + 4, 3 * height, 1);
    OIIO::ImageBuf buffer(OIIO::ImageSpec(line.width, line.height, 1, OIIO::TypeDesc::FLOAT), line.pixels.data());
    const float white = 1.f;
    const bool drawn =
        OIIO::ImageBufAlgo::render_text(buffer, 2, 2 * height, text, height, font, OIIO::cspan<float>(&white, 1));
    for (int row = 0; row < line.height; ++row)
        for (int column = 0; column < line.width; ++column) {
            const int px = left + column - 2, py = baseline + row - 2 * height;
            const float cover = std::clamp(line.at(column, row)[0], 0.f, 1.f);
            if (cover > 0.f && px >= 0 && px < image.width && py >= 0 && py < image.height)
                for (int c = 0; c < std::min(3, image.channels); ++c)
                    image.at(px, py)[c] += (ink[c] - image.at(px, py)[c]) * cover;
        }
    for (const std::size_t place : mus)
        drawStem(image, text, place, left, baseline, height, font, ink);
    return drawn;
}

ContactSheet makeEmptySheet(int width, int height, int letters, const ContactSheetOptions& options, int& top) {
    const int titleLetters = letters * 3 / 2;
    top = options.title.empty() ? 0 : 2 * titleLetters;
    ContactSheet sheet;
    sheet.image = Image(width, top + height);
    for (int y = 0; y < sheet.image.height; ++y)
        for (int x = 0; x < sheet.image.width; ++x)
            sheet.image.setRgb(x, y, options.paper);
    // Letters stand a third of their height above the bottom of their band.
    sheet.hasText = drawText(sheet.image, options.title, 0.5f * float(width),
                             float(std::max(options.gap, 0)) + 1.25f * float(titleLetters), titleLetters, options.ink,
                             TextAlign::centre, 0.92f * float(width));
    return sheet;
}

ContactSheet makeContactSheet(const std::vector<LabelledImage>& images, const ContactSheetOptions& options) {
    if (images.empty())
        throw RunError("contact sheet", "there are no pictures to put on it");
    int cellWidth = 0, cellHeight = 0;
    bool labelled = false;
    for (const LabelledImage& entry : images) {
        if (entry.image.empty() || entry.image.channels != 3)
            throw RunError("contact sheet", "the picture '" + entry.label + "' is empty or not RGB");
        cellWidth = std::max(cellWidth, entry.image.width);
        cellHeight = std::max(cellHeight, entry.image.height);
        labelled = labelled || !entry.label.empty();
    }
    const int count = int(images.size());
    int columns = options.columns;
    if (columns <= 0) {
        // columns · w : rows · h near 16 : 9, with rows = count / columns.
        const double ideal = std::sqrt(count * (16.0 / 9.0) * cellHeight / cellWidth);
        columns = std::clamp(int(std::lround(ideal)), 1, count);
        // The last row should be full where a neighbour of that number makes it so.
        for (int candidate : {columns, columns + 1, columns - 1})
            if (candidate >= 1 && candidate <= count && count % candidate == 0) {
                columns = candidate;
                break;
            }
    }
    columns = std::min(columns, count);
    const int lines = (count + columns - 1) / columns;

    const int letters = options.labelHeight > 0 ? options.labelHeight : std::clamp(cellHeight / 20, 12, 40);
    const int gap = std::max(options.gap, 0);
    const int labelBand = labelled ? 2 * letters : 0;
    int titleBand = 0;
    ContactSheet sheet = makeEmptySheet(gap + columns * (cellWidth + gap), gap + lines * (cellHeight + labelBand + gap),
                                        letters, options, titleBand);
    for (int i = 0; i < count; ++i) {
        const LabelledImage& entry = images[std::size_t(i)];
        const int left = gap + (i % columns) * (cellWidth + gap);
        const int top = titleBand + gap + (i / columns) * (cellHeight + labelBand + gap);
        paste(sheet.image, entry.image, left + (cellWidth - entry.image.width) / 2,
              top + (cellHeight - entry.image.height) / 2);
        const bool drawn = drawText(sheet.image, entry.label, float(left) + 0.5f * float(cellWidth),
                                    float(top + cellHeight) + 1.4f * float(letters), letters, options.ink,
                                    TextAlign::centre, float(cellWidth));
        sheet.hasText = sheet.hasText && drawn;
    }
    return sheet;
}

} // namespace patina
