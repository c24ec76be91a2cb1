#include "figure_plan.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "optics/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>

namespace patina::tool {

namespace {

namespace fs = std::filesystem;

const std::vector<std::string> optionKeys = {"voxels",       "resolution", "picture",   "samples",
                                             "exaggeration", "azimuth",    "elevation", "region_at"};

std::vector<std::string> withOptions(std::vector<std::string> keys) {
    keys.insert(keys.end(), optionKeys.begin(), optionKeys.end());
    return keys;
}

std::optional<int> whole(TomlReader& reader, const toml::table& table, const char* key, double least, double most) {
    const auto value = reader.number(table, key, least, most);
    return value ? std::optional<int>(static_cast<int>(*value)) : std::nullopt;
}

FigureOptions readOptions(TomlReader& reader, const toml::table& table) {
    FigureOptions out;
    out.voxels = whole(reader, table, "voxels", 8, 65536);
    out.resolution = whole(reader, table, "resolution", 16, 32768);
    out.picture = whole(reader, table, "picture", 16, 16384);
    out.samples = whole(reader, table, "samples", 1, 65536);
    out.exaggeration = reader.number(table, "exaggeration", 1e-9, 1e9);
    out.azimuth = reader.number(table, "azimuth", -360.0, 360.0);
    out.elevation = reader.number(table, "elevation", -89.0, 89.0);
    if (const std::string region = reader.word(table, "region_at"); !region.empty())
        out.regionAt = region;
    return out;
}

FigurePanel::Kind kindNamed(TomlReader& reader, const toml::table& table) {
    const std::string word = reader.word(table, "kind", "picture");
    if (word == "slice")
        return FigurePanel::Kind::slice;
    if (word == "map")
        return FigurePanel::Kind::map;
    if (word == "curves")
        return FigurePanel::Kind::curves;
    if (word == "stack")
        return FigurePanel::Kind::stack;
    if (word == "diagram")
        return FigurePanel::Kind::diagram;
    if (word == "stages")
        return FigurePanel::Kind::stages;
    if (word != "picture")
        reader.error(*table.get("kind"), fmt::format("'{}' is not a kind of panel", word),
                     "picture, slice, stack, map, curves, diagram or stages");
    return FigurePanel::Kind::picture;
}

std::vector<std::string> wordList(TomlReader& reader, const toml::table& table, const char* key) {
    std::vector<std::string> words;
    const toml::node* node = table.get(key);
    if (!node)
        return words;
    const toml::array* array = node->as_array();
    for (std::size_t i = 0; array && i < array->size(); ++i)
        if (const auto* text = (*array)[i].as_string())
            words.push_back(text->get());
    if (!array || words.size() != array->size())
        reader.error(*node, fmt::format("'{}' must be a list of texts", key));
    return words;
}

// place = [row, column] or [row, column, rows, columns]
std::optional<FigurePlace> readPlace(TomlReader& reader, const toml::table& table) {
    const toml::node* node = table.get("place");
    if (!node)
        return std::nullopt;
    std::vector<int> numbers;
    if (const toml::array* array = node->as_array()) {
        for (const toml::node& one : *array) {
            const auto number = one.value_exact<std::int64_t>();
            numbers.push_back(number && *number >= 0 && *number < 100 ? int(*number) : -1);
        }
    }
    FigurePlace place;
    if ((numbers.size() != 2 && numbers.size() != 4) || std::count(numbers.begin(), numbers.end(), -1) > 0 ||
        (numbers.size() == 4 && (numbers[2] < 1 || numbers[3] < 1))) {
        reader.error(*node, "'place' must be [row, column] or [row, column, rows, columns]",
                     "rows and columns count from 0");
        return place;
    }
    place.row = numbers[0], place.column = numbers[1];
    if (numbers.size() == 4)
        place.rows = numbers[2], place.columns = numbers[3];
    return place;
}

FigurePanel readPanel(TomlReader& reader, const toml::table& table, const fs::path& dataFolder,
                      const FigureOptions& outer, std::size_t number) {
    reader.allowOnly(table, withOptions({"kind", "label", "script", "text", "model", "set", "map", "at", "along",
                                         "width", "stretch", "by_id", "in_place", "environment", "years", "replaceable",
                                         "environments", "key", "place", "continues"}));
    FigurePanel panel;
    panel.kind = kindNamed(reader, table);
    panel.label = reader.word(table, "label");
    panel.model = reader.word(table, "model", "statuette");
    if (panel.model.find('/') != std::string::npos && fs::exists(dataFolder / panel.model))
        panel.model = (dataFolder / panel.model).string(); // one of the project's own
    panel.options = readOptions(reader, table).over(outer);
    panel.map = reader.word(table, "map", "base_color");
    panel.at = reader.word(table, "at");
    panel.along = reader.word(table, "along");
    panel.width = reader.word(table, "width");
    panel.stretch = reader.number(table, "stretch", 1e-9, 1e12).value_or(0.0);
    panel.byId = reader.truth(table, "by_id");
    panel.inPlace = reader.truth(table, "in_place");
    panel.environment = reader.word(table, "environment");
    panel.years = reader.number(table, "years", 0.1, 1e4).value_or(30.0);
    panel.continues = reader.truth(table, "continues");
    if (panel.continues && number == 1)
        reader.error(*table.get("continues"), "the first panel has nothing to go on from");
    panel.replaceable = reader.truth(table, "replaceable");
    panel.set = wordList(reader, table, "set");
    panel.environments = wordList(reader, table, "environments");
    panel.key = wordList(reader, table, "key");
    panel.place = readPlace(reader, table);
    if (panel.inPlace && panel.stretch > 0.0)
        reader.error(table, "a section in place is not stretched", "leave 'stretch' or 'in_place' out");
    panel.name = fmt::format("panel_{:02}", number);
    panel.script = reader.word(table, "text");
    const std::string file = reader.word(table, "script");
    if (panel.kind == FigurePanel::Kind::stages) {
        if (panel.environment.empty())
            reader.error(table, "stages need an 'environment'");
    } else if (panel.kind == FigurePanel::Kind::diagram) {
        if (panel.environments.empty())
            reader.error(table, "a diagram needs 'environments'");
    } else if (file.empty() == panel.script.empty()) {
        reader.error(table, "a panel has either a 'script' or a 'text'");
    } else if (!file.empty()) {
        const fs::path path = dataFolder / file;
        if (fs::exists(path))
            panel.script = readTextFile(path.string());
        else
            reader.error(*table.get("script"), fmt::format("no such script '{}'", file),
                         fmt::format("paths are relative to {}", dataFolder.string()));
        panel.name = path.stem().string();
    }
    return panel;
}

FigureSeries readSeries(TomlReader& reader, const toml::table& table, const FigureOptions& outer) {
    reader.allowOnly(table, withOptions({"environment", "model", "years", "frames"}));
    FigureSeries series;
    series.environment = reader.word(table, "environment");
    series.model = reader.word(table, "model", "strip");
    series.lastYear = reader.number(table, "years", 0.1, 1e4).value_or(30.0);
    series.frames = whole(reader, table, "frames", 2, 100).value_or(6);
    series.options = readOptions(reader, table).over(outer);
    return series;
}

fs::path fileOf(const fs::path& dataFolder, int number) {
    return dataFolder / "figures" / fmt::format("figure_{:02}.toml", number);
}

} // namespace

FigureOptions FigureOptions::over(const FigureOptions& outer) const {
    FigureOptions out = outer;
    const auto take = [](auto& to, const auto& from) {
        if (from)
            to = from;
    };
    take(out.voxels, voxels);
    take(out.resolution, resolution);
    take(out.picture, picture);
    take(out.samples, samples);
    take(out.exaggeration, exaggeration);
    take(out.azimuth, azimuth);
    take(out.elevation, elevation);
    take(out.regionAt, regionAt);
    return out;
}

void FigureOptions::apply(Options& options) const {
    const auto put = [](auto& to, const auto& from) {
        if (from)
            to = *from;
    };
    put(options.voxels, voxels);
    put(options.resolution, resolution);
    put(options.pictureSize, picture);
    put(options.samples, samples);
    put(options.exaggeration, exaggeration);
    if (azimuth)
        options.azimuth = azimuth;
    if (elevation)
        options.elevation = elevation;
    put(options.regionAt, regionAt);
}

std::vector<int> figureNumbers(const fs::path& dataFolder) {
    std::vector<int> numbers;
    for (int number = 1; number < 100; ++number)
        if (fs::exists(fileOf(dataFolder, number)))
            numbers.push_back(number);
    return numbers;
}

FigurePlan readFigurePlan(const fs::path& dataFolder, int number) {
    const fs::path path = fileOf(dataFolder, number);
    if (!fs::exists(path))
        throw Error(ExitCode::commandLine, "figure", fmt::format("there is no figure {}", number),
                    fmt::format("there are {}", fmt::join(figureNumbers(dataFolder), ", ")));
    std::vector<Diagnostic> findings;
    TomlReader reader(path, dataFolder, findings);
    const std::string text = readTextFile(path.string());
    reader.setText(text);
    FigurePlan plan;
    try {
        const toml::table table = toml::parse(text, path.string());
        reader.allowOnly(table, withOptions({"title", "columns", "series", "panel"}));
        plan.title = reader.word(table, "title");
        plan.columns = whole(reader, table, "columns", 1, 100).value_or(0);
        const FigureOptions outer = readOptions(reader, table);
        if (const toml::array* all = table["series"].as_array())
            for (const toml::node& one : *all)
                if (const toml::table* series = one.as_table())
                    plan.series.push_back(readSeries(reader, *series, outer));
        if (const toml::array* all = table["panel"].as_array())
            for (const toml::node& one : *all)
                if (const toml::table* panel = one.as_table())
                    plan.panels.push_back(readPanel(reader, *panel, dataFolder, outer, plan.panels.size() + 1));
    } catch (const toml::parse_error& error) {
        reader.error(reader.placeOf(error.source().begin), std::string(error.description()));
    }
    if (findings.empty() && plan.series.empty() && plan.panels.empty())
        reader.error(SourcePlace{path.string(), 1, 1}, "the figure shows nothing", "it needs [[panel]] or [[series]]");
    const auto places = std::count_if(plan.panels.begin(), plan.panels.end(),
                                      [](const FigurePanel& panel) { return panel.place.has_value(); });
    if (places > 0 && (std::size_t(places) < plan.panels.size() || !plan.series.empty()))
        reader.error(SourcePlace{path.string(), 1, 1}, "some panels have a place and others do not");
    if (!findings.empty())
        throw ScriptError(findings);
    return plan;
}

} // namespace patina::tool
