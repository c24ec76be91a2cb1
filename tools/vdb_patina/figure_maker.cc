#include "figure_maker.h"

#include "data_folder.h"
#include "outputs.h"
#include "picture.h"
#include "section_input.h"
#include "stage_diagram.h"
#include "weather_series.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "export/bake.h"
#include "optics/colour.h"
#include "optics/toml_reader.h"
#include "render/chart.h"
#include "render/film.h"
#include "volume/vdb_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <regex>

namespace patina::tool {

namespace {

namespace fs = std::filesystem;

// The values of a map as they are; of the part that the model's charts use, for outside them are only their gutters.
Image chartsOf(const MapImage& map, const SurfaceMesh& surface) {
    Imath::Box2f charts;
    for (const Imath::V2f& uv : surface.uvs)
        charts.extendBy(uv);
    const auto texel = [&](float share) { return std::clamp(int(std::lround(share * float(map.size))), 0, map.size); };
    int left = texel(charts.min.x), right = texel(charts.max.x);
    int top = texel(1.f - charts.max.y), bottom = texel(1.f - charts.min.y);
    if (right <= left || bottom <= top)
        left = top = 0, right = bottom = map.size;
    Image values(right - left, bottom - top);
    for (int y = 0; y < values.height; ++y)
        for (int x = 0; x < values.width; ++x) {
            const std::size_t first = (std::size_t(top + y) * map.size + std::size_t(left + x)) * map.channels;
            Imath::V3f value;
            for (int c = 0; c < 3; ++c) {
                const std::size_t i = first + std::size_t(map.channels == 1 ? 0 : c);
                value[c] = map.floats.empty() ? float(map.halves[i]) : map.floats[i];
            }
            values.setRgb(x, y, value);
        }
    return values;
}

// The value that this share of all texels is below, of the largest channel.
float quantile(const Image& values, double share) {
    std::vector<float> all;
    for (int y = 0; y < values.height; ++y)
        for (int x = 0; x < values.width; ++x) {
            const Imath::V3f c = values.rgb(x, y);
            all.push_back(std::max({c.x, c.y, c.z}));
        }
    const auto place = all.begin() + std::ptrdiff_t(share * double(all.size() - 1));
    std::nth_element(all.begin(), place, all.end());
    return *place;
}

// What is shown as black and white, and how that is said.
struct Tones {
    float black = 0.f, white = 1.f;
    std::string words;
};

// Colours of the diffuse light as they are. Lobes, often dark, to their brightest; lengths from nothing to the largest;
// other numbers over their range. But for a few texels, the borders of charts.
Tones tonesOf(const MapImage& map, const Image& values) {
    if (map.name.rfind("lobe_", 0) == 0) {
        const float white = std::max(quantile(values, 0.999), 1e-6f);
        return {0.f, white, fmt::format(" (white: {:.2g})", white)};
    }
    if (map.channels == 3)
        return {};
    if (map.name.rfind("thickness_", 0) == 0) {
        const float white = std::max(quantile(values, 0.999), 1e-6f);
        return {0.f, white, fmt::format(" (white: {:.2g} µm)", white)};
    }
    const float black = quantile(values, 0.02), white = std::max(quantile(values, 0.98), black + 0.05f);
    return {black, white, fmt::format(" (black: {:.2f}, white: {:.2f})", black, white)};
}

ChartOptions chartOptions(const Options& options, const std::string& y, bool stacked) {
    ChartOptions chart;
    chart.width = std::max(options.pictureSize, 240); // axes and legend need room
    chart.height = chart.width * 9 / 16;
    chart.xLabel = "years";
    chart.yLabel = y;
    chart.stacked = stacked;
    return chart;
}

// What a material's file says that it is mixed of.
std::vector<std::pair<std::string, double>> partsOf(const std::string& material) {
    const toml::table table =
        toml::parse(readTextFile((findDataFolder() / "materials" / (material + ".toml")).string()));
    std::vector<std::pair<std::string, double>> parts;
    if (const toml::array* list = table["mixture"]["parts"].as_array())
        for (const toml::node& one : *list)
            if (const toml::table* part = one.as_table())
                parts.emplace_back((*part)["material"].value_or(std::string()), (*part)["volume"].value_or(0.0));
    return parts;
}

// The script with `open` in place of `new`.
std::string goingOnFrom(const std::string& volume, const std::string& script) {
    static const std::regex beginning(R"((^|\n)new[ \t]+\w+)");
    return std::regex_replace(script, beginning, fmt::format("$1open \"{}\"", volume));
}

std::string spaced(std::string name) {
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

} // namespace

FigureMaker::FigureMaker(const Options& options, double scale, fs::path folder, Console& console)
    : options_(options), scale_(scale), folder_(std::move(folder)), console_(console),
      materials_(MaterialLibrary::load(findDataFolder())) {}

Options FigureMaker::optionsOf(const FigureOptions& what) const {
    Options options = options_;
    what.apply(options);
    const auto scaled = [&](int value, int least, double factor) {
        return std::max(least, int(std::lround(value * factor)));
    };
    options.pictureSize = scaled(options.pictureSize, 16, scale_);
    options.resolution = scaled(options.resolution, 16, scale_);
    options.voxels = scaled(options.voxels, 24, scale_);
    options.samples = scaled(options.samples, 1, scale_ * scale_);
    return options;
}

std::vector<LabelledImage> FigureMaker::series(const FigureSeries& what) {
    const Options options = optionsOf(what.options);
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

LabelledImage FigureMaker::panel(const FigurePanel& what, const std::string& otherModel) {
    Options options = optionsOf(what.options);
    options.settings.insert(options.settings.end(), what.set.begin(), what.set.end());
    const std::string model = what.replaceable && !otherModel.empty() ? otherModel : what.model;
    console_.notice(fmt::format("panel '{}'", what.label));
    switch (what.kind) {
    case FigurePanel::Kind::stages:
        return {stages(what, options), what.label};
    case FigurePanel::Kind::diagram:
        return {diagram(what, options), what.label};
    case FigurePanel::Kind::curves:
        return {curves(what, options), what.label};
    default:
        break;
    }
    make(what, model, options);
    SectionInput input;
    input.at = what.at;
    input.along = what.along;
    input.width = what.width;
    input.stretch = what.stretch;
    input.byId = what.byId;
    input.inPlace = what.inPlace;
    switch (what.kind) {
    case FigurePanel::Kind::map:
        return map(what, options);
    case FigurePanel::Kind::slice:
        return {
            makeSection(*made_.volume, materials_, input, options.pictureSize, "", console_, made_.task->model.region)
                .image,
            what.label};
    case FigurePanel::Kind::stack:
        return {makeStackGraph(*made_.volume, materials_, input, options.pictureSize, "", console_,
                               made_.task->model.region)
                    .image,
                what.label};
    default:
        break;
    }
    const StackOptics optics = opticsOf(*made_.volume, materials_, options);
    const fs::path file = folder_ / (what.name + fmt::format("_{:02}.png", ++pictures_));
    writePicture(*made_.volume, made_.task->model, optics, options, file, console_);
    return {readPng(file), what.label};
}

LabelledImage FigureMaker::map(const FigurePanel& what, const Options& options) {
    const StackOptics optics = opticsOf(*made_.volume, materials_, options);
    BakeOptions bakeOptions;
    bakeOptions.resolution = options.pictureSize;
    const MapSet maps = bake(*made_.volume, made_.task->model.surface, optics, bakeOptions, console_);
    const MapImage* map = maps.find(what.map);
    if (!map) {
        std::vector<std::string> names;
        for (const MapImage& one : maps.maps)
            names.push_back(one.name);
        throw RunError(what.name, fmt::format("there is no map '{}'", what.map),
                       fmt::format("there are {}", fmt::join(names, ", ")));
    }
    Image image = chartsOf(*map, made_.task->model.surface);
    const Tones tones = tonesOf(*map, image);
    for (float& value : image.pixels) {
        value = std::clamp((value - tones.black) / (tones.white - tones.black), 0.f, 1.f);
        if (map->channels == 3)
            value = float(encodeSrgb(value));
    }
    return {std::move(image), what.label + tones.words};
}

Image FigureMaker::stages(const FigurePanel& what, const Options& options) const {
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
    return drawChart(series, chartOptions(options, "µm", true)).image;
}
Image FigureMaker::diagram(const FigurePanel& what, const Options& options) const {
    const auto named = [&](const std::string& material, double share = 1.0) {
        return DiagramColour{spaced(material), colourOf(material), share};
    };
    std::vector<DiagramColumn> columns;
    for (const std::string& environment : what.environments) {
        const WeatherPlan plan = readWeatherPlan(findDataFolder(), environment, "copper");
        DiagramColumn column{environment, named(plan.metal), {}};
        const auto add = [&](const std::string& material, std::vector<std::string> when) {
            DiagramStage stage{named(material), std::move(when), {}};
            for (const auto& [part, share] : partsOf(material))
                stage.parts.push_back(named(part, share));
            std::sort(stage.parts.begin(), stage.parts.end(),
                      [](const DiagramColour& a, const DiagramColour& b) { return a.share > b.share; });
            column.stages.push_back(std::move(stage));
        };
        for (const WeatherOxide& oxide : plan.oxides)
            add(oxide.material, {fmt::format("towards {:g} µm,", oxide.thicknessUm),
                                 fmt::format("two thirds after {:g} years", oxide.years)});
        for (const WeatherMineral& mineral : plan.minerals) {
            std::vector<std::string> when{
                fmt::format("from year {:g}, everywhere by {:g}", mineral.begins.first, mineral.begins.second)};
            for (const WeatherConversion& turning : plan.conversions)
                if (turning.from == mineral.material)
                    when.push_back(
                        fmt::format("half becomes {} in {:g} years", spaced(turning.to), turning.halfLifeYears));
            add(mineral.material, when);
        }
        for (const WeatherDeposit& deposit : plan.deposits)
            if (!column.stages.empty())
                column.stages.back().when.push_back(
                    fmt::format("{} settles from year {:g}", spaced(deposit.material), deposit.begins));
        columns.push_back(std::move(column));
    }
    std::vector<DiagramColour> key;
    for (const std::string& material : what.key)
        key.push_back(named(material));
    return drawStageDiagram(columns, key, options.pictureSize).image;
}

Image FigureMaker::curves(const FigurePanel& what, const Options& options) const {
    CheckContext context = checkContext(materials_, options);
    const Program program = readProgram(what.script, what.name, context);
    std::vector<ChartSeries> series;
    for (const Curve& curve : program.curves) {
        // Hues apart from each other, dark enough for a line.
        const float hue = 6.2832f * float(series.size()) / float(program.curves.size());
        ChartSeries one{curve.name,
                        Imath::V3f(0.45f) +
                            Imath::V3f(std::cos(hue), std::cos(hue - 2.094f), std::cos(hue + 2.094f)) * 0.38f,
                        {},
                        {}};
        for (const auto& [year, value] : curve.points) {
            one.x.push_back(year);
            one.y.push_back(value);
        }
        series.push_back(std::move(one));
    }
    return drawChart(series, chartOptions(options, "µm", false)).image;
}
Imath::V3f FigureMaker::colourOf(const std::string& material) const {
    const Imath::V3f& linear = materials_.at(material).swatch;
    return {float(encodeSrgb(linear.x)), float(encodeSrgb(linear.y)), float(encodeSrgb(linear.z))};
}
void FigureMaker::make(const FigurePanel& what, const std::string& model, const Options& options) {
    std::string key =
        fmt::format("{}\n{}\n{} {} {}\n", what.script, model, options.voxels, options.exaggeration, options.regionAt);
    for (const std::string& setting : options.settings)
        key += setting + "\n";
    if (made_.key == key)
        return;
    const fs::path script = folder_ / (what.name + ".patina");
    const bool goesOn = what.continues && made_.volume;
    if (goesOn) {
        const fs::path last = folder_ / (what.name + ".vdb");
        writeVolume(*made_.volume, last);
        made_.session->keep(last, std::move(*made_.volume));
        made_.volume.reset();
        writeTextFile(script, goingOnFrom(last.filename().string(), what.script));
        nextScript(*made_.task, script.string(), materials_, options, console_);
    } else {
        made_ = {};
        writeTextFile(script, what.script);
        made_.task = std::make_unique<Task>(prepareTask(script.string(), model, materials_, options, console_));
        made_.session = std::make_unique<RunSession>();
    }
    const Task& task = *made_.task;
    checkBudget(task, options, console_);
    RunOptions run = runOptionsOf(task, options);
    run.session = made_.session.get();
    RunResult result = runProgram(task.program, task.model.surface, materials_, run, console_);
    if (result.interrupted)
        throw Interrupted();
    made_.volume = std::move(result.volume);
    made_.key = key;
}

} // namespace patina::tool
