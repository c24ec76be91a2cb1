#include "render/stack_graph.h"

#include "base/errors.h"
#include "base/units.h"
#include "render/axis_step.h"
#include "render/contact_sheet.h"
#include "volume/section_sampler.h"
#include "volume/stack_probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

const Imath::V3f paper(0.965f, 0.965f, 0.96f), ink(0.13f, 0.13f, 0.14f), sky(0.90f, 0.93f, 0.95f),
    rule(0.86f, 0.86f, 0.85f);

constexpr int looks = 4000;

void fill(Image& image, int x0, int y0, int x1, int y1, const Imath::V3f& colour) {
    for (int y = std::max(0, y0); y < std::min(image.height, y1); ++y)
        for (int x = std::max(0, x0); x < std::min(image.width, x1); ++x)
            image.setRgb(x, y, colour);
}

void drawLine(Image& image, double x0, double y0, double x1, double y1) {
    const int steps = int(std::ceil(std::max({std::abs(x1 - x0), std::abs(y1 - y0), 1.0})));
    for (int i = 0; i <= steps; ++i) {
        const int x = int(std::lround(x0 + (x1 - x0) * i / steps)), y = int(std::lround(y0 + (y1 - y0) * i / steps));
        if (x >= 0 && x < image.width && y >= 0 && y < image.height)
            image.setRgb(x, y, image.rgb(x, y) + (ink - image.rgb(x, y)) * 0.5f);
    }
}

// From `low` to `high`, scene units as drawn.
std::vector<StackSpan> spansAlong(const SectionSampler& sampler, const SectionSampler::Foot& foot, double low,
                                  double high, double umPerUnit) {
    const auto regionAt = [&](double height) { return sampler.regionAt(foot.position + foot.normal * height); };
    std::vector<StackSpan> spans{{regionAt(low), low * umPerUnit, 0.0}};
    double before = low;
    for (int i = 1; i <= looks; ++i) {
        const double here = low + (high - low) * i / looks;
        const int region = regionAt(here);
        if (region != spans.back().region) {
            double below = before, above = here;
            for (int step = 0; step < 40; ++step) {
                const double middle = 0.5 * (below + above);
                (regionAt(middle) == spans.back().region ? below : above) = middle;
            }
            spans.back().toUm = above * umPerUnit;
            spans.push_back({region, above * umPerUnit, 0.0});
        }
        before = here;
    }
    spans.back().toUm = high * umPerUnit;
    return spans;
}

} // namespace

StackGraph drawStackGraph(const LayerVolume& volume, const std::vector<SectionMaterial>& materials,
                          const StackGraphOptions& options) {
    const SectionSampler sampler(volume);
    const auto foot = sampler.foot(options.at);
    if (!foot)
        throw RunError(
            "graph", fmt::format("there is no metal near ({:g}, {:g}, {:g})", options.at.x, options.at.y, options.at.z),
            "give a point on the model's surface");
    const VolumeScale& scale = volume.scale();
    const double umPerUnit = scale.metresPerUnit * 1e6 / scale.exaggeration;
    std::vector<double> thicknessUm(std::size_t(volume.layerCount()) + 1, 0.0);
    const auto reading = StackProbe(volume).read(foot->position, foot->normal, thicknessUm.data());
    const double top = std::max(reading.height, 0.0), bottom = std::min(reading.metalHeight, 0.0);
    double extent = top - bottom;
    if (!(extent > 0.0))
        extent = 1.0 / umPerUnit; // bare metal: a micrometre of it
    const double low = bottom - 0.25 * extent, high = top + 0.15 * extent;

    StackGraph graph;
    graph.spans = spansAlong(sampler, *foot, low, high, umPerUnit);
    graph.image = Image(options.width, options.height);
    Image& image = graph.image;
    fill(image, 0, 0, image.width, image.height, paper);
    const int letters = std::clamp(options.width / 44, 10, 24);
    const int left = 5 * letters, head = options.title.empty() ? 3 * letters : 9 * letters / 2;
    const int plotHeight = image.height - head - letters, column = std::max(32, image.width / 4);
    const auto rowOf = [&](double um) {
        return head + plotHeight * (high * umPerUnit - um) / ((high - low) * umPerUnit);
    };
    const auto text = [&](const std::string& words, double x, double y, TextAlign align, double widest = 0.0) {
        graph.hasText = drawText(image, words, float(x), float(y), letters, ink, align, float(widest)) && graph.hasText;
    };

    const double step = axisStep((high - low) * umPerUnit, 6);
    for (double um = step * std::ceil(low * umPerUnit / step); um <= high * umPerUnit; um += step) {
        const int row = int(std::lround(rowOf(um)));
        fill(image, left, row, left + column + 3 * letters, row + 1, rule);
        text(fmt::format("{:.6g}", std::abs(um) < 1e-9 * step ? 0.0 : um), left - letters / 2, row + letters / 3,
             TextAlign::right);
    }
    text("µm above the bare metal", letters / 2.0, head - letters, TextAlign::left);
    if (!options.title.empty())
        text(options.title, letters / 2.0, 1.8 * letters, TextAlign::left, image.width - letters);

    // Rows are blended by how much of them each span covers.
    for (int y = head; y < head + plotHeight; ++y) {
        Imath::V3f colour(0.f);
        for (const StackSpan& span : graph.spans) {
            const double cover = std::min(rowOf(span.fromUm), y + 1.0) - std::max(rowOf(span.toUm), double(y));
            if (cover > 0.0)
                colour += (span.region < 0 ? sky : materials[std::size_t(span.region)].colour) * float(cover);
        }
        fill(image, left, y, left + column, y + 1, colour);
    }
    for (const int x : {left, left + column - 1})
        fill(image, x, head, x + 1, head + plotHeight, ink);

    // Names beside the column, pushed apart where spans are thin: from the top down, then up from the bottom.
    std::vector<double> rows;
    const double spacing = 1.5 * letters;
    for (std::size_t i = graph.spans.size(); i-- > 0;) {
        const StackSpan& span = graph.spans[i];
        const double wanted = 0.5 * (rowOf(span.fromUm) + rowOf(span.toUm));
        rows.push_back(rows.empty() ? std::max(wanted, head + 0.6 * letters) : std::max(wanted, rows.back() + spacing));
    }
    double most = head + plotHeight - 0.5 * letters;
    for (std::size_t i = rows.size(); i-- > 0; most -= spacing)
        rows[i] = std::min(rows[i], most);
    for (std::size_t n = 0; n < rows.size(); ++n) {
        const StackSpan& span = graph.spans[graph.spans.size() - 1 - n];
        const int x = left + column + 3 * letters, box = letters;
        drawLine(image, left + column, 0.5 * (rowOf(span.fromUm) + rowOf(span.toUm)), x - 4, rows[n]);
        fill(image, x, int(rows[n]) - box / 2, x + box, int(rows[n]) + box / 2, ink);
        fill(image, x + 1, int(rows[n]) - box / 2 + 1, x + box - 1, int(rows[n]) + box / 2 - 1,
             span.region < 0 ? sky : materials[std::size_t(span.region)].colour);
        const bool within = n > 0 && n + 1 < rows.size();
        const std::string name = span.region < 0 ? "air" : materials[std::size_t(span.region)].name;
        text(within ? fmt::format("{}  {}", name, readableLength(span.toUm - span.fromUm)) : name, x + 1.5 * letters,
             rows[n] + letters / 3.0, TextAlign::left, image.width - x - 2.0 * letters);
    }
    return graph;
}

} // namespace patina
