#include "section_input.h"

#include "point_text.h"

#include "base/errors.h"
#include "base/units.h"
#include "optics/colour.h"
#include "volume/section_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina::tool {

namespace {

Imath::V3d pointOf(const std::string& option, const std::string& text) {
    if (const auto point = pointInText(text))
        return *point;
    throw Error(ExitCode::commandLine, option, fmt::format("'{}' is not a point", text),
                fmt::format("three coordinates, as in {} 0.1,0.2,0.05", option));
}

// A length as scripts write it: 500, 500um, 0.5mm. In µm.
double lengthOf(const std::string& text) {
    std::size_t end = 0;
    double value = 0.0;
    try {
        value = std::stod(text, &end);
    } catch (const std::exception&) {
        end = 0;
    }
    const auto unit = end == text.size() ? std::optional<double>(1.0) : micrometresPerUnit(text.substr(end));
    if (end == 0 || !unit || !(value > 0.0) || !std::isfinite(value))
        throw Error(ExitCode::commandLine, "--width", fmt::format("'{}' is not a length above 0", text),
                    "a number of micrometres, or one with its unit, as in 5mm");
    return value * *unit;
}

Imath::V3f encoded(const Imath::V3f& linear) {
    return {float(encodeSrgb(linear.x)), float(encodeSrgb(linear.y)), float(encodeSrgb(linear.z))};
}

// Hues that neighbours in the stack do not share: steps of the golden ratio around the colour circle.
Imath::V3f colourOfId(std::size_t id) {
    if (id == 0)
        return Imath::V3f(0.45f);
    const double hue = std::fmod(0.08 + double(id) * 0.6180339887, 1.0) * 6.0;
    Imath::V3f colour;
    for (int c = 0; c < 3; ++c) {
        const double distance = std::abs(std::fmod(hue + 6.0 - 2.0 * c + 3.0, 6.0) - 3.0);
        colour[c] = float(0.25 + 0.65 * std::clamp(2.0 - distance, 0.0, 1.0));
    }
    return colour;
}

std::vector<SectionMaterial> materialsOf(const LayerVolume& volume, const MaterialLibrary& library, bool byId) {
    std::vector<SectionMaterial> materials;
    std::vector<std::string> names{volume.metal()};
    names.insert(names.end(), volume.layers().begin(), volume.layers().end());
    for (std::size_t k = 0; k < names.size(); ++k) {
        const Material* material = library.find(names[k]);
        materials.push_back({names[k], byId || !material ? colourOfId(k) : encoded(material->swatch)});
    }
    return materials;
}

// In the volume's coordinates.
Imath::V3d placeOf(const LayerVolume& volume, const SectionInput& input, Console& console,
                   const std::optional<Region>& region) {
    if (!input.at.empty()) {
        const Imath::V3d at = pointOf("--at", input.at);
        return region ? region->toLocal(at) : at;
    }
    const Imath::V3d place = SectionSampler(volume).typicalPlace().position;
    const Imath::V3d at = region ? region->toModel(place) : place;
    console.info(
        fmt::format("cut at ({:.9g}, {:.9g}, {:.9g}), where the stack is most like its mean", at.x, at.y, at.z));
    return place;
}

} // namespace

SectionPicture makeSection(const LayerVolume& volume, const MaterialLibrary& library, const SectionInput& input,
                           int pictureWidth, const std::string& title, Console& console,
                           const std::optional<Region>& region) {
    SectionOptions section;
    section.title = title;
    section.pictureWidth = pictureWidth;
    section.stretch = input.stretch;
    section.unrolled = !input.inPlace;
    section.at = placeOf(volume, input, console, region);
    if (!input.along.empty())
        section.along = pointOf("--along", input.along);
    if (section.along.length() == 0.0)
        throw Error(ExitCode::commandLine, "--along", "a direction of length 0");
    if (!input.width.empty())
        section.width = lengthOf(input.width) * 1e-6 / volume.scale().metresPerUnit;
    return drawSection(volume, materialsOf(volume, library, input.byId), section);
}

StackGraph makeStackGraph(const LayerVolume& volume, const MaterialLibrary& library, const SectionInput& input,
                          int pictureWidth, const std::string& title, Console& console,
                          const std::optional<Region>& region) {
    StackGraphOptions graph;
    graph.title = title;
    graph.width = pictureWidth;
    graph.height = pictureWidth * 3 / 4;
    graph.at = placeOf(volume, input, console, region);
    return drawStackGraph(volume, materialsOf(volume, library, input.byId), graph);
}

} // namespace patina::tool
