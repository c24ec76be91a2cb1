#include "render/section_picture.h"

#include "base/units.h"
#include "render/contact_sheet.h"
#include "volume/section_sampler.h"
#include "volume/stack_probe.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

const Imath::V3f paper(0.965f, 0.965f, 0.96f), ink(0.13f, 0.13f, 0.14f), sky(0.90f, 0.93f, 0.95f);

constexpr int supersamples = 3;

void fill(Image& image, int x0, int y0, int x1, int y1, const Imath::V3f& colour) {
    for (int y = std::max(0, y0); y < std::min(image.height, y1); ++y)
        for (int x = std::max(0, x0); x < std::min(image.width, x1); ++x)
            image.setRgb(x, y, colour);
}

// The largest of 1, 2, 5 times a power of ten that is not above `limit`.
double roundLength(double limit) {
    const double power = std::pow(10.0, std::floor(std::log10(limit)));
    for (const double m : {5.0, 2.0})
        if (m * power <= limit)
            return m * power;
    return power;
}

std::string timesText(double factor) {
    return factor < 100.0 ? fmt::format("{:.3g}", factor) : fmt::format("{:.0f}", factor);
}

void drawNote(SectionPicture& picture, const std::string& text, int x, int y, int letters) {
    picture.hasText = drawText(picture.image, text, float(x), float(y), letters, ink) && picture.hasText;
}

// Where the names and mean thicknesses stand.
struct Legend {
    int left, top, width, height, letters;
};

void drawLegend(SectionPicture& picture, const std::vector<SectionMaterial>& materials, const Legend& at) {
    const int box = at.letters + 2;
    int y = at.top;
    // Top to bottom as they lie.
    for (std::size_t k = materials.size(); k-- > 0 && y + box < at.top + at.height;) {
        fill(picture.image, at.left, y, at.left + box, y + box, ink);
        fill(picture.image, at.left + 1, y + 1, at.left + box - 1, y + box - 1, materials[k].colour);
        const std::string text =
            k == 0 ? materials[k].name
                   : fmt::format("{}  {}", materials[k].name, readableLength(picture.meanThicknessUm[k - 1]));
        picture.hasText = drawText(picture.image, text, float(at.left + box + 6), float(y + box - 3), at.letters, ink,
                                   TextAlign::left, float(at.width - box - 6)) &&
                          picture.hasText;
        y += box + at.letters / 2;
    }
}

} // namespace

SectionPicture drawSection(const LayerVolume& volume, const std::vector<SectionMaterial>& materials,
                           const SectionOptions& options) {
    const VolumeScale& scale = volume.scale();
    const double width = options.width > 0.0 ? options.width : 48.0 * scale.voxelSize;
    const int letters = std::clamp(options.pictureWidth / 60, 11, 28);
    const int margin = letters;
    const int legendWidth = std::max(14 * letters, options.pictureWidth * 3 / 10);
    const int cutWidth = std::max(64, options.pictureWidth - legendWidth - 3 * margin);
    const int cutHeight = cutWidth * 9 / 16;
    const int head = options.title.empty() ? margin : 3 * letters;
    const int foot = 5 * letters / 2;

    const SectionSampler sampler(volume);
    const StackProbe probe(volume);
    const double unitsPerPixel = width / cutWidth;
    const auto feet = sampler.trace(options.at, options.along, unitsPerPixel, cutWidth);

    const SectionSampler::Foot middle = *feet[std::size_t(cutWidth / 2)];
    Imath::V3d tangent = options.along - middle.normal * middle.normal.dot(options.along);
    if (tangent.length() < 1e-6 * options.along.length())
        tangent = middle.normal.cross(Imath::V3d(middle.normal.y, middle.normal.z, middle.normal.x));
    tangent.normalize();

    SectionPicture picture;
    picture.meanThicknessUm.assign(std::size_t(volume.layerCount()), 0.0);
    double highest = 0.0, deepest = 0.0; // above and below the metal as it was, scene units as drawn
    std::vector<double> metalHeights(feet.size(), 0.0);
    std::size_t reached = 0;
    std::vector<double> stack(std::max<std::size_t>(1, picture.meanThicknessUm.size()));
    for (std::size_t i = 0; i < feet.size(); ++i)
        if (const auto& there = feet[i]) {
            ++reached;
            const auto reading = probe.read(there->position, there->normal, stack.data());
            highest = std::max(highest, reading.height);
            metalHeights[i] = reading.metalHeight;
            deepest = std::max(deepest, -reading.metalHeight);
            for (std::size_t k = 0; k < picture.meanThicknessUm.size(); ++k)
                picture.meanThicknessUm[k] += stack[k];
        }
    for (double& thickness : picture.meanThicknessUm)
        thickness /= double(std::max<std::size_t>(1, reached));
    picture.cutFraction = double(reached) / double(feet.size());

    // The stack takes the middle half of the height, the metal a quarter below it, more where it has pits.
    const double fitting = highest > 0.0 || deepest > 0.0 ? std::min(0.55 * cutHeight / std::max(highest, 1e-30),
                                                                     0.7 * cutHeight / (highest + deepest)) *
                                                                unitsPerPixel
                                                          : 1.0;
    double stretch = options.stretch > 0.0 ? options.stretch / scale.exaggeration : fitting;
    if (options.stretch <= 0.0 && stretch * scale.exaggeration > 1.0)
        stretch = std::max(1.0, roundLength(stretch * scale.exaggeration)) / scale.exaggeration;
    picture.stretch = stretch * scale.exaggeration; // against real thickness

    picture.image = Image(options.pictureWidth, head + cutHeight + foot);
    fill(picture.image, 0, 0, picture.image.width, picture.image.height, paper);
    const int left = margin, top = head;
    if (!options.unrolled) {
        stretch = 1.0;
        picture.stretch = scale.exaggeration;
    }
    const double unitsPerRow = unitsPerPixel / stretch;
    // Below pits there is metal, where what lies above leaves the room: a fit gives both together 0.7 of the height.
    const double below = deepest / unitsPerRow / cutHeight + (deepest > 0.0 ? 0.1 : 0.0);
    const double room = std::max(0.55, 0.9 - highest / unitsPerRow / cutHeight);
    const double floorRow = cutHeight * (1.0 - std::clamp(below, 0.25, room));
    picture.rowsPerUm = scale.exaggeration / (scale.metresPerUnit * 1e6) / unitsPerRow;
    picture.metalRow = top + floorRow;
    tbb::parallel_for(0, cutWidth, [&](int x) {
        for (int y = 0; y < cutHeight; ++y) {
            Imath::V3f colour(0.f);
            int above = 0, below = 0;
            for (int sy = 0; sy < supersamples; ++sy) {
                Imath::V3f sample = paper;
                if (!options.unrolled) {
                    const double height = (floorRow - (y + (sy + 0.5) / supersamples)) * unitsPerRow;
                    const double along = (x + 0.5 - 0.5 * cutWidth) * unitsPerPixel;
                    const int region = sampler.regionAt(middle.position + middle.normal * height + tangent * along);
                    sample = region == SectionSampler::air ? sky : materials[std::size_t(region)].colour;
                    (sy == 0 ? above : below) = region;
                } else if (feet[x]) {
                    const double height = (floorRow - (y + (sy + 0.5) / supersamples)) * unitsPerRow;
                    // Below what is left of the metal is metal, however thin the part is.
                    const int region = height < metalHeights[std::size_t(x)]
                                           ? 0
                                           : sampler.regionAt(feet[x]->position + feet[x]->normal * height);
                    sample = region == SectionSampler::air ? sky : materials[std::size_t(region)].colour;
                    (sy == 0 ? above : below) = region;
                }
                colour += sample;
            }
            colour /= float(supersamples);
            // A line between layers, whose colours may be alike.
            if (above != below)
                colour += (ink - colour) * 0.4f;
            // Where the metal was, before it was eroded: a dashed line.
            if (options.unrolled && y == int(floorRow) && metalHeights[std::size_t(x)] < -unitsPerRow &&
                x / (letters / 2) % 2 == 0)
                colour += (ink - colour) * 0.6f;
            picture.image.setRgb(left + x, top + y, colour);
        }
    });

    if (!options.title.empty())
        picture.hasText =
            drawText(picture.image, options.title, float(left), 1.8f * float(letters), letters * 5 / 4, ink) &&
            picture.hasText;

    // Scale bars: lengths below the picture, thicknesses beside it. Both real.
    const double realUmPerUnit = scale.metresPerUnit * 1e6;
    const double barUm = roundLength(0.3 * width * realUmPerUnit);
    const int barPixels = int(std::lround(barUm / realUmPerUnit / unitsPerPixel));
    const int barY = top + cutHeight + letters / 2;
    fill(picture.image, left, barY, left + barPixels, barY + 3, ink);
    drawNote(picture, readableLength(barUm), left + barPixels + letters / 2, barY + letters / 2, letters);

    const double rowUm = unitsPerRow * realUmPerUnit / scale.exaggeration;
    const double heightUm = roundLength(std::min(0.4 * cutHeight, 0.8 * floorRow) * rowUm);
    const int heightPixels = int(std::lround(heightUm / rowUm));
    const int heightX = left + cutWidth + margin / 2;
    fill(picture.image, heightX, top + int(floorRow) - heightPixels, heightX + 3, top + int(floorRow), ink);
    drawNote(picture, readableLength(heightUm), heightX + 8, top + int(floorRow), letters);
    if (std::abs(picture.stretch - 1.0) > 1e-3)
        drawNote(picture, fmt::format("thickness drawn {} times", timesText(picture.stretch)), left + cutWidth / 2,
                 barY + letters / 2, letters);

    const Legend legend{heightX + 8, top, legendWidth - 8, int(floorRow) - 2 * letters, letters};
    drawLegend(picture, materials, legend);
    return picture;
}

} // namespace patina
