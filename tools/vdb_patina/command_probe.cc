// vdb-patina probe VOLUME MODEL --at x,y,z

#include "commands.h"
#include "console.h"
#include "existing_volume.h"
#include "outputs.h"

#include "base/errors.h"
#include "optics/colour.h"
#include "surface/ray_scene.h"
#include "volume/stack_probe.h"

#include <fmt/format.h>

namespace patina::tool {

namespace {

struct Arguments {
    std::string volume;
    std::string model;
    std::vector<double> at; ///< x, y, z, x, y, z …
    bool csv = false;
};

void probeVolume(const Arguments& arguments, const Options& options, Console& console) {
    if (arguments.at.empty() || arguments.at.size() % 3 != 0)
        throw Error(ExitCode::commandLine, "--at", "a point has three coordinates, as in --at 0.1,0.2,0.05");
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
    for (std::size_t i = 0; i < arguments.at.size(); i += 3) {
        const Imath::V3f wanted(Imath::V3d(arguments.at[i], arguments.at[i + 1], arguments.at[i + 2]));
        const auto closest = scene.closest(wanted);
        const Imath::V3d position = positionAt(input.model.surface, closest->point);
        std::vector<double> thickness(std::max<std::size_t>(1, layers.size()));
        std::vector<float> thicknessUm(thickness.size());
        const auto reading = probe.read(position, normalAt(input.model.surface, closest->point), thickness.data());
        if (!reading.found)
            console.warning("no metal was found along the normal here");
        for (std::size_t k = 0; k < layers.size(); ++k)
            thicknessUm[k] = static_cast<float>(thickness[k]);
        Appearance look;
        optics.evaluate(thicknessUm.data(), look);
        const Imath::V3d lab = labFromXyz(xyzFromLinearRec709(Imath::V3d(look.baseColour)));
        if (arguments.csv) {
            std::string row = fmt::format("{:.9g},{:.9g},{:.9g},{:.2f},{:.2f},{:.2f},{:.3f}", position.x, position.y, position.z,
                                          lab.x, lab.y, lab.z, look.flattenedRoughness);
            for (std::size_t k = 0; k < layers.size(); ++k)
                row += fmt::format(",{:.6g}", thickness[k]);
            console.result(row);
            continue;
        }
        std::string text = fmt::format("at ({:.6g}, {:.6g}, {:.6g}), {:.3g} scene units from the point asked for\n", position.x,
                                       position.y, position.z, closest->distance);
        for (std::size_t k = layers.size(); k-- > 0;)
            text += fmt::format("  {:<24} {:10.4f} µm\n", layers[k], thickness[k]);
        text += fmt::format("  {:<24} {:>10}\n", input.volume.metal(), "bulk");
        text += fmt::format("  colour L*a*b* {:.1f} {:.1f} {:.1f} ({}), metallic {:.2f}, roughness {:.2f}", lab.x, lab.y, lab.z,
                            srgbHex(Imath::V3d(look.baseColour)), look.metallic, look.flattenedRoughness);
        console.result(text);
    }
}

} // namespace

void addProbeCommand(CLI::App& app, Options& options, Action& action) {
    CLI::App* command = app.add_subcommand("probe", "The stack at points: layers, µm, colour, roughness");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("VOLUME", arguments->volume, "A .vdb that `run` wrote")->required();
    command->add_option("MODEL", arguments->model, "The model it was made from")->required();
    command->add_option("--at", arguments->at, "A point near the surface, scene units; may be given several times")
        ->required()
        ->delimiter(',')
        ->type_name("X,Y,Z");
    command->add_flag("--csv", arguments->csv, "One line per point, with a head line");
    addGeneralOptions(*command, options);
    addModelOptions(*command, options);
    command->callback([&options, &action, arguments] {
        action = [&options, arguments](Console& console) { probeVolume(*arguments, options, console); };
    });
}

} // namespace patina::tool
