#include "stage_diagram.h"

#include "base/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina::tool {

namespace {

const Imath::V3f paper(0.965f, 0.965f, 0.96f), ink(0.13f, 0.13f, 0.14f), air(0.90f, 0.93f, 0.95f);

void fill(Image& image, int x0, int y0, int x1, int y1, const Imath::V3f& colour) {
    for (int y = std::max(0, y0); y < std::min(image.height, y1); ++y)
        for (int x = std::max(0, x0); x < std::min(image.width, x1); ++x)
            image.setRgb(x, y, colour);
}

void frame(Image& image, int x0, int y0, int x1, int y1, const Imath::V3f& colour) {
    fill(image, x0, y0, x1, y1, ink);
    fill(image, x0 + 1, y0 + 1, x1 - 1, y1 - 1, colour);
}

void arrowDown(Image& image, int x, int y0, int y1, int size) {
    fill(image, x - 1, y0, x + 1, y1 - size, ink);
    for (int i = 0; i < size; ++i)
        fill(image, x - (size - i), y1 - size + i, x + (size - i), y1 - size + i + 1, ink);
}

} // namespace

ContactSheet drawStageDiagram(const std::vector<DiagramColumn>& columns, const std::vector<DiagramColour>& key,
                              int width) {
    std::size_t stages = 0, lines = 0; // of text beside a stage
    for (const DiagramColumn& column : columns) {
        stages = std::max(stages, column.stages.size());
        for (const DiagramStage& stage : column.stages)
            lines = std::max(lines, 1 + stage.when.size() + stage.parts.size());
    }
    if (columns.empty() || stages == 0)
        throw RunError("diagram", "there are no stages to draw");
    const int letters = std::clamp(width / 80, 8, 22), gap = letters;
    const int columnWidth = (width - gap) / int(columns.size()) - gap;
    const int band = letters * 5 / 4, line = letters * 3 / 2;
    const int slab = band * int(stages + 2), text = std::max(slab, line * int(lines));
    const int stageHeight = text + 3 * letters, head = 3 * letters;
    const int keyHeight = key.empty() ? 0 : 4 * letters;

    ContactSheet sheet;
    sheet.image = Image(width, head + int(stages) * stageHeight + keyHeight);
    Image& image = sheet.image;
    fill(image, 0, 0, image.width, image.height, paper);
    const auto write = [&](const std::string& words, int x, int y, double widest, TextAlign align = TextAlign::left,
                           int height = 0) {
        sheet.hasText =
            drawText(image, words, float(x), float(y), height > 0 ? height : letters, ink, align, float(widest)) &&
            sheet.hasText;
    };
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const DiagramColumn& column = columns[c];
        const int left = gap + int(c) * (columnWidth + gap), slabWidth = columnWidth * 3 / 10;
        write(column.title, left + columnWidth / 2, head - letters, columnWidth, TextAlign::centre, letters * 3 / 2);
        for (std::size_t s = 0; s < column.stages.size(); ++s) {
            const DiagramStage& stage = column.stages[s];
            const int top = head + int(s) * stageHeight, bottom = top + text;
            // What lies there by now: metal two bands thick, a band for each layer.
            frame(image, left, top, left + slabWidth, bottom, air);
            frame(image, left, bottom - 2 * band, left + slabWidth, bottom, column.metal.colour);
            for (std::size_t k = 0; k <= s; ++k) {
                const int y = bottom - (int(k) + 3) * band;
                frame(image, left, y, left + slabWidth, y + band + 1, column.stages[k].layer.colour);
            }
            const int x = left + slabWidth + letters, room = columnWidth - slabWidth - letters;
            write(fmt::format("{}  {}", s + 1, stage.layer.name), x, top + line - letters / 2, room);
            int row = 2;
            for (const std::string& when : stage.when)
                write(when, x, top + row++ * line - letters / 2, room);
            for (const DiagramColour& part : stage.parts) {
                const int y = top + row++ * line - letters / 2;
                frame(image, x, y - letters + 2, x + letters, y + 2, part.colour);
                write(fmt::format("{} {:.0f} %", part.name, 100.0 * part.share), x + letters * 3 / 2, y,
                      room - letters * 3 / 2);
            }
            if (s + 1 < column.stages.size())
                arrowDown(image, left + slabWidth / 2, bottom + letters / 2, bottom + 5 * letters / 2, letters / 2);
        }
    }
    const int keyTop = head + int(stages) * stageHeight + letters;
    for (std::size_t i = 0; i < key.size(); ++i) {
        const int cell = (width - 2 * gap) / int(key.size()), x = gap + int(i) * cell;
        frame(image, x, keyTop, x + 2 * letters, keyTop + 2 * letters, key[i].colour);
        write(key[i].name, x + letters * 5 / 2, keyTop + letters * 4 / 3, cell - letters * 5 / 2);
    }
    return sheet;
}

} // namespace patina::tool
