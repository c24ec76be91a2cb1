// vdb-patina figure N: the paper's figures, made by this program

#include "command_line.h"
#include "commands.h"
#include "console.h"
#include "data_folder.h"
#include "figure_plan.h"
#include "outputs.h"
#include "picture.h"
#include "script_run.h"
#include "section_input.h"
#include "weather_series.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "export/bake.h"
#include "optics/colour.h"
#include "render/chart.h"
#include "render/contact_sheet.h"
#include "render/film.h"

#include <fmt/format.h>

#include <cmath>

namespace patina::tool {

namespace {

namespace fs = std::filesystem;

struct Arguments {
    int number = 0;
    std::string model;
};

// A volume that several panels look at is made once.
struct MadeVolume {
    std::string key;
    std::optional<Task> task;
    std::optional<LayerVolume> volume;
};

Image imageOfMap(const MapImage& map) {
    Image image(map.size, map.size);
    const auto valueAt = [&](std::size_t i) { return map.floats.empty() ? float(map.halves[i]) : map.floats[i]; };
    const std::size_t count = std::size_t(map.size) * map.size * map.channels;
    float most = map.channels == 1 ? 1e-30f : 1.f; // of lengths and shares the largest is white
    for (std::size_t i = 0; i < count && map.channels == 1; ++i)
        most = std::max(most, valueAt(i));
    for (int y = 0; y < map.size; ++y)
        for (int x = 0; x < map.size; ++x) {
            const std::size_t first = (std::size_t(y) * map.size + x) * map.channels;
            Imath::V3f colour;
            for (int c = 0; c < 3; ++c) {
                const float value = valueAt(first + (map.channels == 1 ? 0 : c)) / most;
                colour[c] = map.channels == 1 ? std::max(0.f, value) : float(encodeSrgb(value));
            }
            image.setRgb(x, y, colour);
        }
    return image;
}

// The part of a map that the model's charts use: outside them are only their gutters.
Image cutToCharts(const Image& map, const SurfaceMesh& surface) {
    Imath::Box2f charts;
    for (const Imath::V2f& uv : surface.uvs)
        charts.extendBy(uv);
    const auto texel = [](float share, int size) { return std::clamp(int(std::lround(share * float(size))), 0, size); };
    const int left = texel(charts.min.x, map.width), right = texel(charts.max.x, map.width);
    const int top = texel(1.f - charts.max.y, map.height), bottom = texel(1.f - charts.min.y, map.height);
    Image cut(right - left, bottom - top);
    for (int y = 0; y < cut.height; ++y)
        for (int x = 0; x < cut.width; ++x)
            cut.setRgb(x, y, map.rgb(left + x, top + y));
    return cut.empty() ? map : cut;
}

class FigureMaker {
  public:
    FigureMaker(const Options& options, fs::path folder, Console& console)
        : options_(options), folder_(std::move(folder)), console_(console),
          materials_(MaterialLibrary::load(findDataFolder())) {}

    std::vector<LabelledImage> series(const FigureSeries& what) {
        Options options = options_;
        what.options.apply(options);
        const WeatherPlan plan = readWeatherPlan(findDataFolder(), what.environment, "copper");
        std::vector<double> years;
        for (int i = 0; i < what.frames; ++i)
            years.push_back(what.lastYear * i / (what.frames - 1));
        WeatherSeries run;
        run.model = what.model;
        run.environment = what.environment;
        run.maps = "none";
        run.frames = weatherScripts(plan, {}, years, what.environment);
        auto pictures = runWeatherSeries(run, options, folder_ / what.environment, console_);
        for (LabelledImage& picture : pictures)
            picture.label = fmt::format("{}, {}", what.environment, picture.label);
        return pictures;
    }

    LabelledImage panel(const FigurePanel& what, const std::string& otherModel) {
        Options options = options_;
        what.options.apply(options);
        options.settings.insert(options.settings.end(), what.set.begin(), what.set.end());
        const std::string model = what.replaceable && !otherModel.empty() ? otherModel : what.model;
        console_.notice(fmt::format("panel '{}'", what.label));
        if (what.kind == FigurePanel::Kind::stages)
            return {stages(what, options), what.label};
        if (what.kind == FigurePanel::Kind::curves)
            return {curves(what, options), what.label};
        make(what, model, options);
        const StackOptics optics = opticsOf(*made_.volume, materials_, options);
        if (what.kind == FigurePanel::Kind::map) {
            BakeOptions bakeOptions;
            bakeOptions.resolution = options.pictureSize;
            const MapSet maps = bake(*made_.volume, made_.task->model.surface, optics, bakeOptions, console_);
            const MapImage* map = maps.find(what.map);
            if (!map)
                throw RunError(what.name, fmt::format("there is no map '{}'", what.map));
            return {cutToCharts(imageOfMap(*map), made_.task->model.surface), what.label};
        }
        if (what.kind == FigurePanel::Kind::slice) {
            SectionInput input;
            input.at = what.at;
            input.along = what.along;
            input.width = what.width;
            input.stretch = what.stretch;
            input.byId = what.byId;
            input.inPlace = what.inPlace;
            SectionPicture picture = makeSection(*made_.volume, materials_, input, options.pictureSize, "", console_);
            return {std::move(picture.image), what.label};
        }
        const fs::path file = folder_ / (what.name + fmt::format("_{:02}.png", ++pictures_));
        writePicture(*made_.volume, made_.task->model, optics, options, file, console_);
        return {readPng(file), what.label};
    }

  private:
    static ChartOptions chartOptions(const Options& options, const std::string& y, bool stacked) {
        ChartOptions chart;
        chart.width = options.pictureSize;
        chart.height = options.pictureSize * 9 / 16;
        chart.xLabel = "years";
        chart.yLabel = y;
        chart.stacked = stacked;
        return chart;
    }

    Image stages(const FigurePanel& what, const Options& options) const {
        const WeatherPlan plan = readWeatherPlan(findDataFolder(), what.environment, "copper");
        std::vector<ChartSeries> series;
        for (const WeatherOxide& oxide : plan.oxides)
            series.push_back({oxide.material, colourOf(oxide.material), {}, {}});
        for (const WeatherMineral& mineral : plan.minerals)
            series.push_back({mineral.material, colourOf(mineral.material), {}, {}});
        constexpr int points = 60;
        for (int i = 0; i <= points; ++i) {
            const double year = what.years * i / points;
            const auto thickness = layerThicknessesUm(plan, {}, year);
            for (std::size_t k = 0; k < series.size(); ++k) {
                series[k].x.push_back(year);
                series[k].y.push_back(thickness[k]);
            }
        }
        return drawChart(series, chartOptions(options, "um", true)).image;
    }

    Image curves(const FigurePanel& what, const Options& options) {
        CheckContext context = checkContext(materials_, options);
        const Program program = readProgram(what.script, what.name, context);
        std::vector<ChartSeries> series;
        for (const Curve& curve : program.curves) {
            // Hues apart from each other, dark enough for a line.
            const float hue = 6.2832f * float(series.size()) / float(program.curves.size());
            ChartSeries one{curve.name, Imath::V3f(0.45f) + Imath::V3f(std::cos(hue), std::cos(hue - 2.094f),
                                                                      std::cos(hue + 2.094f)) * 0.38f, {}, {}};
            for (const auto& [year, value] : curve.points) {
                one.x.push_back(year);
                one.y.push_back(value);
            }
            series.push_back(std::move(one));
        }
        return drawChart(series, chartOptions(options, "um", false)).image;
    }

    Imath::V3f colourOf(const std::string& material) const {
        const Imath::V3f& linear = materials_.at(material).swatch;
        return {float(encodeSrgb(linear.x)), float(encodeSrgb(linear.y)), float(encodeSrgb(linear.z))};
    }

    void make(const FigurePanel& what, const std::string& model, const Options& options) {
        std::string key = fmt::format("{}\n{}\n{} {}\n", what.script, model, options.voxels, options.exaggeration);
        for (const std::string& setting : options.settings)
            key += setting + "\n";
        if (made_.key == key)
            return;
        made_ = {};
        const fs::path script = folder_ / (what.name + ".patina");
        writeTextFile(script, what.script);
        Task task = prepareTask(script.string(), model, materials_, options, console_);
        checkBudget(task, options, console_);
        RunResult result =
            runProgram(task.program, task.model.surface, materials_, runOptionsOf(task, options), console_);
        if (result.interrupted)
            throw Interrupted();
        made_.task = std::move(task);
        made_.volume = std::move(result.volume);
        made_.key = key;
    }

    const Options& options_;
    fs::path folder_;
    Console& console_;
    MaterialLibrary materials_;
    MadeVolume made_;
    int pictures_ = 0;
};

void figure(const Arguments& arguments, const Options& options, Console& console) {
    const FigurePlan plan = readFigurePlan(findDataFolder(), arguments.number);
    const std::string name = fmt::format("figure_{:02}", arguments.number);
    const fs::path folder = outputFolder(options, name);
    FigureMaker maker(options, folder, console);
    std::vector<LabelledImage> images;
    for (const FigureSeries& series : plan.series)
        for (LabelledImage& image : maker.series(series))
            images.push_back(std::move(image));
    for (const FigurePanel& panel : plan.panels)
        images.push_back(maker.panel(panel, arguments.model));
    ContactSheetOptions sheetOptions;
    sheetOptions.title = plan.title;
    sheetOptions.columns = plan.columns;
    const ContactSheet sheet = makeContactSheet(images, sheetOptions);
    if (!sheet.hasText)
        console.warning("no font was found on this machine: the figure has no labels");
    const fs::path file = folder / (name + ".png");
    writePng(sheet.image, file, {{"Software", "vdb-patina " PATINA_VERSION}, {"Description", plan.title}});
    console.result(file.string());
}

} // namespace

void addFigureCommand(CLI::App& app, Options& options, Action& action) {
    CLI::App* command = app.add_subcommand("figure", "Figures of Dorsey and Hanrahan 1996, made by this program");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("NUMBER", arguments->number, "Of the figure in the paper")->required();
    command->add_option("--model", arguments->model, "Another model, where the figure shows one object")
        ->type_name("FILE")
        ->group("Figure");
    addGeneralOptions(*command, options);
    addOutputOption(*command, options);
    command->callback([&options, &action, arguments] {
        action = [&options, arguments](Console& console) { figure(*arguments, options, console); };
    });
}

} // namespace patina::tool
