// vdb-patina materials [NAME], vdb-patina materials fit

#include "commands.h"
#include "console.h"
#include "data_folder.h"
#include "outputs.h"
#include "swatch.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "base/names.h"
#include "optics/colour.h"
#include "optics/material_fit.h"
#include "optics/material_library.h"
#include "optics/spectrum_file.h"
#include "render/film.h"

#include <fmt/format.h>

#include <cstdlib>
#include <limits>

namespace patina::tool {

namespace {

void list(const MaterialLibrary& library, Console& console) {
    for (const std::string& name : library.names()) {
        const Material& m = library.at(name);
        console.result(fmt::format("{:<20} {} {} {}{}", name, srgbHex(Imath::V3d(m.swatch)),
                                   m.isMetal ? "metal" : "layer", m.title, m.isEstimate ? " (estimate)" : ""));
    }
}

const Material* findMaterial(const MaterialLibrary& library, const std::string& name) {
    const Material* found = library.find(name);
    if (!found)
        throw Error(ExitCode::commandLine, name, "there is no material of this name",
                    didYouMean(name, library.names()));
    return found;
}

void detail(const MaterialLibrary& library, const std::string& name, Console& console) {
    const Material* m = findMaterial(library, name);
    std::string text = fmt::format("{}: {}\n", m->name, m->title);
    const Imath::V3d lab = labFromXyz(xyzFromLinearRec709(Imath::V3d(m->swatch)));
    text += fmt::format("  an opaque layer is {} (L*a*b* {:.1f} {:.1f} {:.1f})\n", srgbHex(Imath::V3d(m->swatch)),
                        lab.x, lab.y, lab.z);
    text += fmt::format("  roughness {:.3g}, refractive index {:.3g}, hardness {:.3g}, solid fraction {:.3g}\n",
                        m->roughness, m->refractiveIndex, m->hardness, m->density);
    text += fmt::format("  specular colour {:.3f} {:.3f} {:.3f} (linear, normal incidence), density {}\n",
                        m->specularColour.x, m->specularColour.y, m->specularColour.z,
                        m->densityKgPerM3 > 0.f ? fmt::format("{:.0f} kg/m³ of the solid", m->densityKgPerM3)
                                                : std::string("not known"));
    if (m->isEstimate)
        text += "  some of these are estimates: the source below says which\n";
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

void drawSwatch(const MaterialLibrary& library, const std::string& name, std::string over, const Options& options,
                Console& console) {
    const Material* material = findMaterial(library, name);
    if (over.empty())
        over = name.rfind("cuprite", 0) == 0 ? "tenorite" : "cuprite";
    findMaterial(library, over);
    const Swatch swatch = makeSwatch(library, name, over);
    if (!swatch.hasText)
        console.warning("no font was found on this machine: the picture has no labels");
    const OutputFolder folder = outputFolder(options, name);
    const auto file = folder.path() / (name + "_swatch.png");
    writePng(swatch.image, file, {{"Software", "vdb-patina " PATINA_VERSION}});
    if (!material->isMetal)
        console.info(fmt::format("over copper it is opaque from {:.3g} µm on (CIEDE2000 below 1)", swatch.opaqueUm));
    console.result(file.string());
}

struct FitArguments {
    std::string name = "fitted";
    std::string opaque, layer, second;
    std::string column = "reflectance";
    std::string backing = "0", secondBacking;
    double thicknessUm = 0.0, scattering = 0.0, index = 1.5;
    bool body = false; ///< the samples are without the interface with air
};

/// A file of reflectances, freed of the first surface where it was measured in air.
TabulatedSpectrum reflectances(const std::string& file, const FitArguments& arguments) {
    TabulatedSpectrum spectrum = readSpectrumFile(file, arguments.column, {0.0, 1.0, "reflectance"});
    return arguments.body ? spectrum : bodyReflectance(spectrum, arguments.index);
}

/// A number (of the body), or a file measured as the sample was.
TabulatedSpectrum backingOf(const std::string& text, const FitArguments& arguments, const char* option) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (end == text.c_str() || *end != '\0')
        return reflectances(text, arguments);
    if (!(value >= 0.0 && value <= 1.0))
        throw Error(ExitCode::commandLine, option, fmt::format("a backing reflects 0 to 1, not {}", text),
                    "give a number, or a file of reflectances");
    return {{550.0}, {value}};
}

void fit(const FitArguments& arguments, const Options& options, Console& console) {
    const auto measured = [&](const std::string& file, const std::string& backing, const char* option) {
        return MeasuredLayer{reflectances(file, arguments), backingOf(backing, arguments, option),
                             arguments.thicknessUm, file};
    };
    const auto opaque = [&] {
        return MeasuredLayer{
            reflectances(arguments.opaque, arguments), {}, std::numeric_limits<double>::infinity(), arguments.opaque};
    };
    FittedCoefficients fitted;
    std::string source = "Fitted by vdb-patina materials fit from ";
    if (!arguments.opaque.empty() && !arguments.layer.empty() && arguments.second.empty()) {
        fitted = fitOpaqueAndThin(opaque(), measured(arguments.layer, arguments.backing, "--backing"));
        source += fmt::format("{} (opaque) and {} ({:g} um over {})", arguments.opaque, arguments.layer,
                              arguments.thicknessUm, arguments.backing);
    } else if (!arguments.opaque.empty() && arguments.layer.empty() && arguments.second.empty()) {
        fitted = fitOpaque(opaque(), arguments.scattering);
        source += fmt::format("{} (opaque), with an assumed scattering of {:g} per um", arguments.opaque,
                              arguments.scattering);
    } else if (arguments.opaque.empty() && !arguments.layer.empty() && !arguments.second.empty()) {
        fitted = fitTwoBackings(measured(arguments.layer, arguments.backing, "--backing"),
                                measured(arguments.second, arguments.secondBacking, "--second-backing"));
        source += fmt::format("{} ({:g} um over {}) and {} (over {})", arguments.layer, arguments.thicknessUm,
                              arguments.backing, arguments.second, arguments.secondBacking);
    } else {
        throw Error(
            ExitCode::commandLine, "materials fit", "these samples do not make a fit",
            "give --opaque with --scattering; --opaque and --layer; or --layer and --second with their backings");
    }
    source += arguments.body ? std::string("; reflectances of the body")
                             : fmt::format("; measured in air, interface of index {:g} removed", arguments.index);
    const OutputFolder folder = outputFolder(options, arguments.name);
    const auto file = folder.path() / (arguments.name + ".toml");
    writeTextFile(file, materialFileOf(arguments.name, fitted, arguments.index, source + "."));
    std::string text = "  wavelength/nm   K/(1/µm)   S/(1/µm)\n";
    for (std::size_t i = 0; i < fitted.absorption.values.size(); ++i)
        text += fmt::format("  {:>12g}   {:8.4f}   {:8.4f}\n", fitted.absorption.wavelengthsNm[i],
                            fitted.absorption.values[i], fitted.scattering.values[i]);
    console.result(text + file.string());
}

void addFitCommand(CLI::App& materials, Options& options, Action& action) {
    CLI::App* command = materials.add_subcommand("fit", "K and S of a layer from measured reflectances");
    auto a = std::make_shared<FitArguments>();
    const std::string group = "Samples (files with the columns wavelength_nm and reflectance)";
    command->add_option("--name", a->name, "Of the new material (default fitted)")->type_name("NAME")->group(group);
    command->add_option("--opaque", a->opaque, "An opaque sample")->type_name("FILE")->group(group);
    command->add_option("--layer", a->layer, "A thin one, of known thickness")->type_name("FILE")->group(group);
    command->add_option("--backing", a->backing, "What it lies on: a reflectance or a file (default 0, black)")
        ->type_name("R|FILE")
        ->group(group);
    auto* second = command->add_option("--second", a->second, "The same layer on another backing")
                       ->type_name("FILE")
                       ->group(group);
    command->add_option("--second-backing", a->secondBacking, "That backing")
        ->needs(second)
        ->type_name("R|FILE")
        ->group(group);
    second->needs(command->get_option("--second-backing"));
    command->add_option("--thickness", a->thicknessUm, "Of the layer, solid, in µm")->type_name("UM")->group(group);
    command->add_option("--scattering", a->scattering, "S that is assumed, 1/µm, where there is no thin sample")
        ->type_name("S")
        ->group(group);
    command->add_option("--column", a->column, "Of the files (default reflectance)")->type_name("NAME")->group(group);
    command->add_option("--index", a->index, "Refractive index of the interface with air (default 1.5)")
        ->check(CLI::Range(1.0, 4.0))
        ->type_name("N")
        ->group(group);
    command->add_flag("--body", a->body, "The reflectances are the body's, the interface is not in them")->group(group);
    addGeneralOptions(*command, options);
    addOutputOption(*command, options);
    command->callback(
        [&options, &action, a] { action = [&options, a](Console& console) { fit(*a, options, console); }; });
}

} // namespace

void addMaterialsCommand(CLI::App& app, Options& options, Action& action) {
    CLI::App* command = app.add_subcommand("materials", "Lists the materials; one in detail, with a swatch; fit");
    auto name = std::make_shared<std::string>();
    auto over = std::make_shared<std::string>();
    command->add_option("NAME", *name, "A material: its numbers, and NAME_swatch.png");
    command->add_option("--over", *over, "The layer that the second strip lies on (default cuprite)")
        ->type_name("MATERIAL")
        ->group("Swatch");
    addGeneralOptions(*command, options);
    addOutputOption(*command, options);
    addFitCommand(*command, options, action);
    command->callback([command, &options, &action, name, over] {
        if (!command->get_subcommands().empty())
            return; // fit
        action = [&options, name, over](Console& console) {
            const MaterialLibrary library = MaterialLibrary::load(findDataFolder());
            if (name->empty()) {
                list(library, console);
                return;
            }
            detail(library, *name, console);
            drawSwatch(library, *name, *over, options, console);
        };
    });
}

} // namespace patina::tool
