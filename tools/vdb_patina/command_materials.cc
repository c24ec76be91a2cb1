// vdb-patina materials [NAME]

#include "commands.h"
#include "console.h"
#include "data_folder.h"

#include "base/errors.h"
#include "base/names.h"
#include "optics/colour.h"
#include "optics/material_library.h"

#include <fmt/format.h>

namespace patina::tool {

namespace {

void list(const MaterialLibrary& library, Console& console) {
    for (const std::string& name : library.names()) {
        const Material& m = library.at(name);
        console.result(fmt::format("{:<20} {} {} {}{}", name, srgbHex(Imath::V3d(m.swatch)),
                                   m.isMetal ? "metal" : "layer", m.title, m.isEstimate ? " (estimate)" : ""));
    }
}

void detail(const MaterialLibrary& library, const std::string& name, Console& console) {
    const Material* m = library.find(name);
    if (!m)
        throw Error(ExitCode::commandLine, name, "there is no material of this name",
                    didYouMean(name, library.names()));
    std::string text = fmt::format("{}: {}\n", m->name, m->title);
    const Imath::V3d lab = labFromXyz(xyzFromLinearRec709(Imath::V3d(m->swatch)));
    text += fmt::format("  an opaque layer is {} (L*a*b* {:.1f} {:.1f} {:.1f})\n", srgbHex(Imath::V3d(m->swatch)),
                        lab.x, lab.y, lab.z);
    text += fmt::format("  roughness {:.3g}, refractive index {:.3g}, hardness {:.3g}, solid fraction {:.3g}\n",
                        m->roughness, m->refractiveIndex, m->hardness, m->density);
    text += m->isMetal ? "  wavelength/nm  R(normal incidence)\n" : "  wavelength/nm  R_inf      K/(1/µm)   S/(1/µm)\n";
    for (int i = 0; i < bandCount; ++i) {
        text += fmt::format("  {:>12.0f}  {:8.4f}", bandWavelengthNm(i), m->reflectance[i]);
        if (!m->isMetal)
            text += fmt::format("   {:8.4f}   {:8.4f}", m->absorption[i], m->scattering[i]);
        text += "\n";
    }
    text += "  source: " + m->source;
    console.result(text);
}

} // namespace

void addMaterialsCommand(CLI::App& app, Options& options, Action& action) {
    CLI::App* command = app.add_subcommand("materials", "Lists the materials; one in detail");
    auto name = std::make_shared<std::string>();
    command->add_option("NAME", *name, "A material");
    addGeneralOptions(*command, options);
    command->callback([&action, name] {
        action = [name](Console& console) {
            const MaterialLibrary library = MaterialLibrary::load(findDataFolder());
            if (name->empty())
                list(library, console);
            else
                detail(library, *name, console);
        };
    });
}

} // namespace patina::tool
