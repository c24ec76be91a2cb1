// vdb-patina weather MODEL --environment E --years N

#include "command_line.h"
#include "commands.h"
#include "console.h"
#include "data_folder.h"
#include "outputs.h"
#include "view_input.h"
#include "weather_series.h"

#include "base/errors.h"
#include "render/film.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <sstream>

namespace patina::tool {

namespace {

namespace fs = std::filesystem;

// There are many of them, and they are looked at side by side. Where a patina is matt 8 or 16 paths are enough; the
// polished metal of the first takes all.
constexpr PictureDefaults framePictures{480, 24, 5.0};

struct Arguments {
    std::string model;
    std::string environment;
    std::string metal = "copper";
    std::string years = "30";
    int frames = 6;
    std::string category;
    bool extremes = false;
    std::optional<double> latitude;
    std::string maps = "last";
    bool render = false;
    int between = 0;
    double framesPerSecond = 12.0;
};

// "30" with a number of frames, or "A:B:STEP".
std::vector<double> yearsOf(const Arguments& arguments) {
    std::vector<double> numbers;
    std::istringstream in(arguments.years);
    std::string part;
    bool good = true;
    while (std::getline(in, part, ':')) {
        char* end = nullptr;
        numbers.push_back(std::strtod(part.c_str(), &end));
        good = good && !part.empty() && *end == '\0' && std::isfinite(numbers.back()) && numbers.back() >= 0.0;
    }
    good = good && (numbers.size() == 1 || numbers.size() == 3);
    if (good && numbers.size() == 1)
        good = numbers[0] > 0.0;
    if (good && numbers.size() == 3 && numbers[1] < numbers[0])
        throw Error(ExitCode::commandLine, "--years",
                    fmt::format("'{}' runs backwards: year {:g} comes before year {:g}", arguments.years, numbers[1],
                                numbers[0]),
                    "first:last:step, as in --years 0:30:5");
    if (good && numbers.size() == 3)
        good = numbers[2] > 0.0;
    if (!good)
        throw Error(ExitCode::commandLine, "--years", fmt::format("'{}' is not a time", arguments.years),
                    "a number of years above 0, as in --years 30, or first:last:step, as in --years 0:30:5");
    std::vector<double> years;
    if (numbers.size() == 3) {
        const double count = std::floor((numbers[1] - numbers[0]) / numbers[2] + 1e-9);
        if (count > 10000.0)
            throw Error(ExitCode::commandLine, "--years",
                        fmt::format("'{}' has more than 10000 frames", arguments.years), "use a larger step");
        for (int i = 0; i <= static_cast<int>(count); ++i)
            years.push_back(numbers[0] + i * numbers[2]);
    } else if (arguments.frames == 1) {
        years = {numbers[0]};
    } else {
        for (int i = 0; i < arguments.frames; ++i)
            years.push_back(numbers[0] * i / (arguments.frames - 1));
    }
    return years;
}

void runHistory(const Arguments& arguments, const WeatherPlan& plan, const WeatherKinetics& kinetics,
                const std::vector<double>& years, const Options& options, const fs::path& folder, Console& console) {
    WeatherSeries series;
    series.model = arguments.model;
    series.environment = arguments.environment;
    series.maps = arguments.maps;
    series.film = arguments.render;
    series.between = arguments.between;
    series.framesPerSecond = arguments.framesPerSecond;
    series.frames = weatherScripts(plan, kinetics, years, arguments.environment);
    if (options.dryRun) {
        for (const WeatherFrame& frame : series.frames)
            console.result(frame.script);
        return;
    }
    const std::vector<LabelledImage> pictures = runWeatherSeries(series, options, folder, console);
    if (pictures.empty())
        return;
    ContactSheetOptions sheetOptions;
    sheetOptions.title = plan.title;
    if (!kinetics.category.empty())
        sheetOptions.title += ", category " + kinetics.category;
    const ContactSheet sheet = makeContactSheet(pictures, sheetOptions);
    if (!sheet.hasText)
        console.warning("no font was found on this machine: the sheet has no labels");
    writePng(sheet.image, folder / "contact_sheet.png", {{"Software", "vdb-patina " PATINA_VERSION}});
    console.result((folder / "contact_sheet.png").string());
}

// Before years are run through, not after.
void checkPictures(const Arguments& arguments, const Options& options) {
    if (arguments.render && options.pictureSize == 0)
        throw Error(ExitCode::commandLine, "--render", "a film of pictures of 0 pixels", "leave --picture 0 out");
    if (arguments.between > 0 && options.from == "volume")
        throw Error(ExitCode::commandLine, "--between",
                    "what lies between two frames is shown on the displaced mesh, not on voxels",
                    "leave --from volume out");
    if (options.pictureSize > 0 && options.light != "studio")
        lightsOf(options, 0.f, {}); // any but the studio stand alone
}

void weather(const Arguments& arguments, const Options& options, Console& console) {
    const std::vector<double> years = yearsOf(arguments);
    WeatherPlan plan = readWeatherPlan(findDataFolder(), arguments.environment, arguments.metal);
    if (arguments.latitude)
        setLatitude(plan, *arguments.latitude);
    WeatherKinetics kinetics;
    kinetics.category = arguments.category;
    patinaThicknessUm(plan, kinetics, 1.0); // an unknown category is told before anything is made
    if (arguments.extremes && arguments.category.empty() && !hasPaperRange(plan))
        throw Error(ExitCode::commandLine, "--extremes",
                    "only a category has a range, and the paper's rate for copper in the city",
                    "give one with --category");
    checkPictures(arguments, options);
    std::optional<OutputFolder> output;
    if (!options.dryRun)
        output.emplace(outputFolder(options, fs::path(arguments.model).stem().string() + "_weather"));
    const fs::path folder = output ? output->path() : fs::path();
    if (!arguments.extremes) {
        runHistory(arguments, plan, kinetics, years, options, folder, console);
        return;
    }
    for (const bool most : {false, true}) {
        kinetics.position = most ? 1.0 : 0.0;
        const fs::path here = folder / (most ? "most" : "least");
        if (!options.dryRun)
            fs::create_directories(here);
        runHistory(arguments, plan, kinetics, years, options, here, console);
    }
}

} // namespace

void addWeatherCommand(CLI::App& app, Options& options, Action& action) {
    CLI::App* command =
        app.add_subcommand("weather", "Lets years pass: scripts, one result per frame, a contact sheet");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("MODEL", arguments->model, "OBJ, PLY, STL or OFF file, or a shape of `make`")->required();
    const std::string group = "Weather";
    command->add_option("--environment", arguments->environment, "marine, rural or urban")
        ->check(oneOf({"marine", "rural", "urban"}))
        ->required()
        ->type_name("NAME")
        ->group(group);
    command->add_option("--metal", arguments->metal, "copper (default), zinc or steel")
        ->check(oneOf({"copper", "zinc", "steel"}))
        ->type_name("NAME")
        ->group(group);
    command->add_option("--years", arguments->years, "How many (default 30), or first:last:step")
        ->type_name("N")
        ->group(group);
    command->add_option("--frames", arguments->frames, "Frames from the bare metal to the last year (default 6)")
        ->check(wholeNumberWithin(1, 10000))
        ->type_name("K")
        ->group(group);
    command
        ->add_option("--category", arguments->category,
                     "Corrosivity category of ISO 9223, C1 to CX (default: the paper's rates)")
        ->type_name("C")
        ->group(group);
    command
        ->add_flag("--extremes", arguments->extremes,
                   "Two series, for the least and the most of the category (or of the paper's rate)")
        ->group(group);
    command->add_option("--latitude", arguments->latitude, "Of the place, degrees, north positive (default 45)")
        ->type_name("DEGREES")
        ->group(group);
    command->add_option("--maps", arguments->maps, "Bake the maps of all frames, the last (default) or none")
        ->check(oneOf({"all", "last", "none"}))
        ->type_name("WHICH")
        ->group(group);
    addGeneralOptions(*command, options);
    addOutputOption(*command, options);
    addModelOptions(*command, options);
    addVolumeOptions(*command, options);
    addMapOptions(*command, options);
    addPictureOptions(*command, options, framePictures);
    addRenderOptions(*command, options);
    addRunOptions(*command, options);
    const std::string film = "Time-lapse";
    auto* render =
        command
            ->add_flag("--render", arguments->render, "A time-lapse: the pictures as a film, where ffmpeg is installed")
            ->group(film);
    command
        ->add_option("--between", arguments->between,
                     "Pictures between one frame and the next, of the stack's thicknesses in between (default 0)")
        ->check(wholeNumberWithin(0, 1000))
        ->needs(render)
        ->type_name("N")
        ->group(film);
    command->add_option("--fps", arguments->framesPerSecond, "Pictures of the film in a second (default 12)")
        ->check(numberWithin(0.1, 240.0))
        ->needs(render)
        ->type_name("N")
        ->group(film);
    command->add_flag("--resume", options.resume, "Go on with an interrupted series in the same folder")->group("Run");
    command->callback([&options, &action, arguments, command] {
        takeDefaults(*command, framePictures, options);
        action = [&options, arguments](Console& console) { weather(*arguments, options, console); };
    });
}

} // namespace patina::tool
