#include "swatch.h"

#include "base/errors.h"
#include "optics/layer_stack.h"
#include "render/chart.h"
#include "render/contact_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace patina::tool {

namespace {

constexpr int width = 760, margin = 24, letters = 15, stripHeight = 56, spectrumHeight = 300;
constexpr double underUm = 1.0; // of the other layer
const Imath::V3f paper(0.965f, 0.965f, 0.96f), ink(0.13f, 0.13f, 0.14f);

/// All light that comes back where light comes from everywhere: what a diffuse sky shows.
Imath::V3d seen(const Appearance& look) {
    Imath::V3d colour(look.diffuse);
    for (const Lobe& lobe : look.lobes)
        colour += Imath::V3d(lobe.colour);
    return colour;
}

using ColourOf = std::function<Imath::V3d(double thicknessUm)>;

struct Strip {
    std::string title;
    double mostUm;
    ColourOf colour;
};

ColourOf overStack(const StackOptics& optics, double belowUm) {
    return [&optics, belowUm](double um) {
        Appearance look;
        const float layers[2] = {static_cast<float>(belowUm > 0.0 ? belowUm : um), static_cast<float>(um)};
        optics.evaluate(layers, look);
        return seen(look);
    };
}

// From where on nothing changes that an eye could tell.
double opaqueFrom(const ColourOf& colour) {
    const auto lab = [&](double um) { return labFromXyz(xyzFromLinearRec709(colour(um))); };
    const Imath::V3d end = lab(1e4);
    double low = 0.0, high = 0.01;
    while (high < 1e4 && deltaE2000(lab(high), end) >= 1.0)
        low = high, high *= 1.25;
    for (int i = 0; i < 20; ++i) {
        const double middle = 0.5 * (low + high);
        (deltaE2000(lab(middle), end) >= 1.0 ? low : high) = middle;
    }
    return high;
}

std::string lengthText(double um, bool inNanometres) {
    return um == 0.0 ? "0" : inNanometres ? fmt::format("{:g} nm", 1000.0 * um) : fmt::format("{:g} µm", um);
}

// Steps of 1, 2 or 5 times a power of ten, about six.
double stepOf(double most) {
    const double power = std::pow(10.0, std::floor(std::log10(most / 6.0)));
    for (const double m : {1.0, 2.0, 5.0})
        if (m * power >= most / 6.0 * (1.0 - 1e-9))
            return m * power;
    return 10.0 * power;
}

int drawStrip(Swatch& swatch, const Strip& strip, int top) {
    const auto text = [&](const std::string& words, double x, int y, TextAlign align) {
        swatch.hasText = drawText(swatch.image, words, float(x), float(y), letters, ink, align) && swatch.hasText;
    };
    text(strip.title, margin, top + letters, TextAlign::left);
    const int first = top + letters * 8 / 5, across = width - 2 * margin;
    for (int x = 0; x < across; ++x) {
        const Imath::V3d linear = strip.colour(strip.mostUm * x / (across - 1.0));
        const Imath::V3f shown(float(encodeSrgb(linear.x)), float(encodeSrgb(linear.y)), float(encodeSrgb(linear.z)));
        for (int y = 0; y < stripHeight; ++y)
            swatch.image.setRgb(margin + x, first + y, shown);
    }
    const double step = stepOf(strip.mostUm);
    for (double um = 0.0; um <= strip.mostUm * (1.0 + 1e-9); um += step) {
        const int x = margin + int(std::lround((across - 1) * um / strip.mostUm));
        for (int y = 0; y < 6; ++y)
            swatch.image.setRgb(x, first + stripHeight + y, ink);
        const bool last = um + 0.5 * step > strip.mostUm;
        text(lengthText(um, strip.mostUm < 0.2), x, first + stripHeight + 6 + letters * 6 / 5,
             um == 0.0 ? TextAlign::left
             : last    ? TextAlign::right
                       : TextAlign::centre);
    }
    return first + stripHeight + 6 + letters * 5 / 2;
}

Image spectrumOf(const Material& material, bool& hasText) {
    ChartSeries series;
    series.name = material.isMetal ? "R, normal" : "R, opaque";
    series.colour = Imath::V3f(0.16f, 0.4f, 0.8f);
    for (int i = 0; i < fineCount; ++i)
        if (fineWavelengthNm(i) >= 400.0 && fineWavelengthNm(i) <= 700.0) {
            series.x.push_back(fineWavelengthNm(i));
            series.y.push_back(material.fineReflectance[std::size_t(i)]);
        }
    ChartOptions options;
    options.width = width;
    options.height = spectrumHeight;
    options.xFirst = 400.0;
    options.xLabel = "nm";
    options.yLabel = "reflectance, without the interface with air";
    if (material.isMetal)
        options.yLabel = "reflectance";
    const Chart chart = drawChart({series}, options);
    hasText = hasText && chart.hasText;
    return chart.image;
}

} // namespace

Swatch makeSwatch(const MaterialLibrary& library, const std::string& name, const std::string& over) {
    const Material& material = library.at(name);
    const Material& below = library.at(over);
    if (below.isMetal)
        throw Error(ExitCode::commandLine, "--over", fmt::format("{} is a metal", over),
                    "give a layer, such as cuprite");
    const Material& copper = library.at("copper");
    Swatch swatch;

    const StackOptics onCopper({&copper, material.isMetal ? &below : &material});
    const StackOptics onLayer({&copper, &below, material.isMetal ? &below : &material});
    StackFeatures thin;
    thin.thinFilm = true;
    const StackOptics interfering({&copper, material.isMetal ? &below : &material}, OpticsModel::energyConserving,
                                  thin);
    const StackOptics bare({&material}, OpticsModel::energyConserving);

    std::vector<Strip> strips;
    if (material.isMetal) {
        strips.push_back({"bare", 1.0, [&](double) {
                              Appearance look;
                              bare.evaluate(nullptr, look);
                              return seen(look);
                          }});
    } else {
        const ColourOf alone = overStack(onCopper, 0.0), other = overStack(onLayer, underUm);
        swatch.opaqueUm = opaqueFrom(alone);
        // One scale for both, to where both are opaque: it takes more to hide the darker ground.
        const double mostUm = std::max(swatch.opaqueUm, opaqueFrom(other));
        strips.push_back({"over copper", mostUm, alone});
        strips.push_back({fmt::format("over {:g} µm of {} on copper", underUm, over), mostUm, other});
        if (material.hasIndex)
            strips.push_back(
                {"over copper, its first weeks: interference", thickestInterferingUm, overStack(interfering, 0.0)});
    }
    const int head = letters * 3, each = letters * 8 / 5 + stripHeight + 6 + letters * 5 / 2 + letters / 2;
    swatch.image = Image(width, head + int(strips.size()) * each + spectrumHeight);
    for (int y = 0; y < swatch.image.height; ++y)
        for (int x = 0; x < width; ++x)
            swatch.image.setRgb(x, y, paper);
    swatch.hasText = drawText(swatch.image, fmt::format("{}: {}", name, material.title), margin, letters * 2.f,
                              letters * 5 / 4, ink, TextAlign::left, width - 2.f * margin);
    int top = head;
    for (const Strip& strip : strips)
        top = drawStrip(swatch, strip, top) + letters / 2;
    const Image spectrum = spectrumOf(material, swatch.hasText);
    for (int y = 0; y < spectrum.height && head + int(strips.size()) * each + y < swatch.image.height; ++y)
        for (int x = 0; x < width; ++x)
            swatch.image.setRgb(x, head + int(strips.size()) * each + y, spectrum.rgb(x, y));
    return swatch;
}

} // namespace patina::tool
