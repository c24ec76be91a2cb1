// vdb-patina probe VOLUME [MODEL] --at x,y,z

#include "commands.h"
#include "console.h"
#include "existing_volume.h"
#include "outputs.h"
#include "point_text.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "optics/colour.h"
#include "surface/ray_scene.h"
#include "volume/stack_probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iostream>
#include <optional>
#include <sstream>

namespace patina::tool {

namespace {

struct Arguments {
    std::string volume;
    std::string model;
    std::vector<std::string> at; ///< "x,y,z"
    std::string pointFile;
    bool csv = false;
};

// Empty lines, comments and a head line are no points.
void readPoints(std::istream& in, const std::string& place, std::vector<Imath::V3d>& points) {
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
        const std::size_t first = line.find_first_not_of(" \t\r");
        if (first == std::string::npos || line[first] == '#')
            continue;
        if (const auto point = pointInText(line))
            points.push_back(*point);
        else if (number > 1 || std::isalpha(static_cast<unsigned char>(line[first])) == 0)
            throw RunError(fmt::format("{}:{}", place, number), fmt::format("'{}' is not a point", line),
                           "a point has three coordinates, as in 0.1,0.2,0.05");
    }
}

std::vector<Imath::V3d> pointsOf(const Arguments& arguments) {
    std::vector<Imath::V3d> points;
    for (const std::string& text : arguments.at) {
        const auto point = pointInText(text);
        if (!point)
            throw Error(ExitCode::commandLine, "--at", fmt::format("'{}' is not a point", text),
                        "a point has three coordinates, as in --at 0.1,0.2,0.05");
        points.push_back(*point);
    }
    if (arguments.pointFile == "-") {
        readPoints(std::cin, "stdin", points);
    } else if (!arguments.pointFile.empty()) {
        std::istringstream in(readTextFile(arguments.pointFile));
        readPoints(in, arguments.pointFile, points);
    } else if (points.empty()) {
        throw Error(ExitCode::commandLine, "--at", "no point was given",
                    "as in --at 0.1,0.2,0.05, or give a file with --points");
    }
    return points;
}

void probeVolume(const Arguments& arguments, const Options& options, Console& console) {
    const std::vector<Imath::V3d> points = pointsOf(arguments);
    const ExistingVolume input = loadExisting(arguments.volume, arguments.model, options, console);
    const StackOptics optics = opticsOf(input.volume, input.materials, options);
    const StackProbe probe(input.volume);
    const RayScene scene(input.model.surface.positions, input.model.surface.triangles);
    const auto& layers = input.volume.layers();
    if (arguments.csv) {
        std::string head = "x,y,z,L,a,b,roughness";
        for (const std::string& layer : layers)
            head += "," + layer + "_um";
        console.result(head);
    }
    for (const Imath::V3d& wanted : points) {
        console.checkpoint();
        const auto closest = scene.closest(Imath::V3f(input.model.toLocal(wanted)));
        const Imath::V3d local = positionAt(input.model.surface, closest->point), position = input.model.toModel(local);
        std::vector<double> thickness(std::max<std::size_t>(1, layers.size()));
        std::vector<float> thicknessUm(thickness.size());
        const auto reading = probe.read(local, normalAt(input.model.surface, closest->point), thickness.data());
        if (!reading.found)
            console.warning(fmt::format("({:g}, {:g}, {:g}): no metal was found along the normal here", wanted.x,
                                        wanted.y, wanted.z));
        for (std::size_t k = 0; k < layers.size(); ++k)
            thicknessUm[k] = static_cast<float>(thickness[k]);
        Appearance look;
        optics.evaluate(thicknessUm.data(), look);
        const Imath::V3d lab = labFromXyz(xyzFromLinearRec709(Imath::V3d(look.baseColour)));
        if (arguments.csv) {
            std::string row = fmt::format("{:.7g},{:.7g},{:.7g},{:.2f},{:.2f},{:.2f},{:.3f}", position.x, position.y,
                                          position.z, lab.x, lab.y, lab.z, look.flattenedRoughness);
            for (std::size_t k = 0; k < layers.size(); ++k)
                row += fmt::format(",{:.6g}", thickness[k]);
            console.result(row);
            continue;
        }
        std::string text = fmt::format("at ({:.6g}, {:.6g}, {:.6g}), {:.3g} scene units from the point asked for\n",
                                       position.x, position.y, position.z, closest->distance / input.model.magnification());
        for (std::size_t k = layers.size(); k-- > 0;)
            text += fmt::format("  {:<24} {:10.4f} µm\n", layers[k], thickness[k]);
        text += fmt::format("  {:<24} {:>10}\n", input.volume.metal(), "bulk");
        text += fmt::format("  colour L*a*b* {:.1f} {:.1f} {:.1f} ({}), metallic {:.2f}, roughness {:.2f}", lab.x,
                            lab.y, lab.z, srgbHex(Imath::V3d(look.baseColour)), look.metallic, look.flattenedRoughness);
        console.result(text);
    }
}

} // namespace

void addProbeCommand(CLI::App& app, Options& options, Action& action) {
    CLI::App* command = app.add_subcommand("probe", "The stack at points: layers, µm, colour, roughness");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("VOLUME", arguments->volume, "A .vdb that `run` wrote")->required();
    command->add_option("MODEL", arguments->model,
                        "The model it was made from (default: the .obj that `run` wrote beside it)");
    command->add_option("--at", arguments->at, "A point near the surface, scene units; may be given several times")
        ->allow_extra_args(false)
        ->type_name("X,Y,Z")
        ->group("Points");
    command->add_option("--points", arguments->pointFile, "A file of points, one line each: x,y,z or x y z; - is stdin")
        ->type_name("FILE")
        ->group("Points");
    command->add_flag("--csv", arguments->csv, "One line per point, with a head line")->group("Points");
    addGeneralOptions(*command, options);
    addModelOptions(*command, options);
    addOpticsOptions(*command, options);
    command->callback([&options, &action, arguments] {
        action = [&options, arguments](Console& console) { probeVolume(*arguments, options, console); };
    });
}

} // namespace patina::tool
