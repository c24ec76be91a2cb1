#include "script/weather_plan.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "base/names.h"
#include "optics/toml_reader.h"
#include "script/vocabulary.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <regex>

namespace patina {

namespace {

namespace fs = std::filesystem;

constexpr double paperYears = 20.0; // "almost negligible rate after about 20 years"

class PlanReader {
  public:
    PlanReader(const fs::path& path, std::vector<Diagnostic>& findings)
        : reader_(path, path.parent_path(), findings), findings_(findings) {
        const std::string text = readTextFile(path.string());
        reader_.setText(text);
        try {
            table_ = toml::parse(text, path.string());
        } catch (const toml::parse_error& error) {
            reader_.error(reader_.placeOf(error.source().begin), std::string(error.description()));
        }
    }

    const toml::table& table() const { return table_; }
    TomlReader& reader() { return reader_; }

    double needed(const toml::table& table, const char* key, double least, double most) {
        if (!table.get(key))
            reader_.error(reader_.placeOf(table), fmt::format("'{}' is missing", key));
        return reader_.number(table, key, least, most).value_or(least);
    }

    std::string neededWord(const toml::table& table, const char* key) {
        if (!table.get(key))
            reader_.error(reader_.placeOf(table), fmt::format("'{}' is missing", key));
        return reader_.word(table, key);
    }

    std::pair<double, double> range(const toml::table& table, const char* key, double most) {
        std::vector<double> values;
        if (reader_.numbers(table, key, values, nullptr) &&
            (values.size() != 2 || !(values[0] >= 0.0) || !(values[1] >= values[0]) || values[1] > most))
            reader_.error(*table.get(key),
                          fmt::format("'{}' must be two numbers, the smaller one first, 0 to {:g}", key, most));
        return values.size() == 2 ? std::make_pair(values[0], values[1]) : std::make_pair(0.0, 0.0);
    }

    WeatherPattern pattern(const toml::table& table) {
        WeatherPattern out;
        out.model = neededWord(table, "pattern");
        if (table.get("pattern") && !vocabulary::contains(vocabulary::growthModels(), out.model))
            reader_.error(*table.get("pattern"), fmt::format("unknown growth model '{}'", out.model),
                          fmt::format("the models are {}", vocabulary::listed(vocabulary::growthModels())));
        out.total = static_cast<int>(needed(table, "total", 1, 1000));
        out.even = needed(table, "even", 0.0, 1.0);
        out.map = reader_.word(table, "map");
        return out;
    }

    // The tables of an array such as [[oxide]].
    template <typename Read>
    void each(const char* key, const std::vector<std::string>& keys, Read read) {
        const toml::node* node = table_.get(key);
        if (!node)
            return;
        const toml::array* array = node->as_array();
        if (!array) {
            reader_.error(*node, fmt::format("'{0}' must be tables headed [[{0}]]", key));
            return;
        }
        for (const toml::node& entry : *array)
            if (const toml::table* one = entry.as_table()) {
                reader_.allowOnly(*one, keys);
                read(*one);
            }
    }

  private:
    TomlReader reader_;
    std::vector<Diagnostic>& findings_;
    toml::table table_;
};

void readLayers(PlanReader& file, WeatherPlan& plan) {
    file.each("oxide", {"material", "thickness_um", "years", "expansion", "pattern", "total", "even", "map"},
              [&](const toml::table& table) {
                  WeatherOxide oxide;
                  oxide.material = file.neededWord(table, "material");
                  oxide.thicknessUm = file.needed(table, "thickness_um", 0.0, 1e4);
                  oxide.years = file.needed(table, "years", 1e-3, 1e4);
                  oxide.expansion = file.reader().number(table, "expansion", 0.1, 100.0).value_or(0.0);
                  oxide.pattern = file.pattern(table);
                  plan.oxides.push_back(oxide);
              });
    file.each("mineral", {"material", "begins", "share", "expansion", "pattern", "total", "even", "map"},
              [&](const toml::table& table) {
                  WeatherMineral mineral;
                  mineral.material = file.neededWord(table, "material");
                  mineral.begins = file.range(table, "begins", 1e4);
                  mineral.share = file.reader().number(table, "share", 0.0, 1.0).value_or(1.0);
                  mineral.expansion = file.reader().number(table, "expansion", 0.1, 100.0).value_or(0.0);
                  mineral.pattern = file.pattern(table);
                  plan.minerals.push_back(mineral);
              });
}

void readEvents(PlanReader& file, WeatherPlan& plan) {
    file.each("conversion", {"from", "to", "half_life_years", "begins"}, [&](const toml::table& table) {
        WeatherConversion conversion;
        conversion.from = file.neededWord(table, "from");
        conversion.to = file.neededWord(table, "to");
        conversion.halfLifeYears = file.needed(table, "half_life_years", 1e-3, 1e6);
        conversion.begins = file.reader().number(table, "begins", 0.0, 1e4).value_or(0.0);
        plan.conversions.push_back(conversion);
    });
    file.each("wear", {"um_per_year", "begins", "map"}, [&](const toml::table& table) {
        WeatherWear wear;
        wear.umPerYear = file.needed(table, "um_per_year", 0.0, 1e4);
        wear.begins = file.reader().number(table, "begins", 0.0, 1e4).value_or(0.0);
        wear.map = file.reader().word(table, "map");
        plan.wear.push_back(wear);
    });
    file.each("deposit", {"material", "um_per_year", "begins", "pattern", "total", "even", "map"},
              [&](const toml::table& table) {
                  WeatherDeposit deposit;
                  deposit.material = file.neededWord(table, "material");
                  deposit.umPerYear = file.needed(table, "um_per_year", 0.0, 1e4);
                  deposit.begins = file.reader().number(table, "begins", 0.0, 1e4).value_or(0.0);
                  deposit.pattern = file.pattern(table);
                  plan.deposits.push_back(deposit);
              });
}

} // namespace

std::vector<std::string> weatherPlans(const fs::path& dataFolder) {
    std::vector<std::string> names;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(dataFolder / "weather", ignored))
        if (entry.path().extension() == ".toml" && entry.path().stem() != "kinetics")
            names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

WeatherPlan readWeatherPlan(const fs::path& dataFolder, const std::string& environment, const std::string& metal) {
    const std::string name = metal + "_" + environment;
    const std::vector<std::string> known = weatherPlans(dataFolder);
    if (std::find(known.begin(), known.end(), name) == known.end())
        throw Error(ExitCode::commandLine, name,
                    fmt::format("nothing is known about the weathering of {} in this environment", metal),
                    fmt::format("there are plans for {}", vocabulary::listed(known)));
    std::vector<Diagnostic> findings;
    WeatherPlan plan;
    PlanReader file(dataFolder / "weather" / (name + ".toml"), findings);
    file.reader().allowOnly(file.table(), {"title", "metal", "kinetics", "paper_um_per_year", "expansion", "retained",
                                           "oxide", "mineral", "conversion", "wear", "deposit"});
    plan.title = file.neededWord(file.table(), "title");
    plan.metal = file.neededWord(file.table(), "metal");
    if (const toml::node* rate = file.table().get("paper_um_per_year"); rate && rate->is_array())
        plan.paperUmPerYear = file.range(file.table(), "paper_um_per_year", 1e4);
    else if (const auto number = file.reader().number(file.table(), "paper_um_per_year", 0.0, 1e4))
        plan.paperUmPerYear = std::make_pair(*number, *number);
    plan.expansion = file.needed(file.table(), "expansion", 0.1, 100.0);
    plan.retained = file.needed(file.table(), "retained", 0.0, 1.0);
    readLayers(file, plan);
    readEvents(file, plan);
    const Kinetics kinetics = readKinetics(dataFolder, findings);
    const std::string of = file.neededWord(file.table(), "kinetics");
    if (const auto found = kinetics.metals.find(of); found != kinetics.metals.end())
        plan.course = found->second;
    else if (const toml::node* asked = file.table().get("kinetics"))
        file.reader().error(*asked, fmt::format("there are no kinetics of '{}'", of), "kinetics.toml has those there are");
    const auto complete = [&](auto& layer) {
        const auto known = kinetics.expansion.find(layer.material);
        if (layer.expansion == 0.0)
            layer.expansion = known != kinetics.expansion.end() ? known->second : plan.expansion;
    };
    std::for_each(plan.oxides.begin(), plan.oxides.end(), complete);
    std::for_each(plan.minerals.begin(), plan.minerals.end(), complete);
    if (!findings.empty())
        throw ScriptError(findings);
    return plan;
}

void setLatitude(WeatherPlan& plan, double degrees) {
    if (!(std::abs(degrees) <= 90.0))
        throw Error(ExitCode::commandLine, "--latitude", fmt::format("{:g} is beyond the poles", degrees),
                    "give degrees from -90 (south) to 90 (north)");
    static const std::regex field(R"(\b(exposure|wetness)\b(?!\s*\())");
    const auto set = [&](std::string& map) {
        map = std::regex_replace(map, field, fmt::format("$1(latitude={:g})", degrees));
    };
    for (WeatherOxide& oxide : plan.oxides)
        set(oxide.pattern.map);
    for (WeatherMineral& mineral : plan.minerals)
        set(mineral.pattern.map);
    for (WeatherWear& wear : plan.wear)
        set(wear.map);
    for (WeatherDeposit& deposit : plan.deposits)
        set(deposit.pattern.map);
}

bool hasPaperRange(const WeatherPlan& plan) {
    return plan.paperUmPerYear && plan.paperUmPerYear->second > plan.paperUmPerYear->first;
}

double patinaThicknessUm(const WeatherPlan& plan, const WeatherKinetics& kinetics, double years) {
    if (years <= 0.0)
        return 0.0;
    if (kinetics.category.empty()) {
        if (!plan.paperUmPerYear)
            throw Error(ExitCode::commandLine, "--category", fmt::format("the paper has no rate for {}", plan.metal),
                        "give a corrosivity category of ISO 9223, C1 to CX, as in --category C3");
        const auto [least, most] = *plan.paperUmPerYear;
        const double x = std::min(years / paperYears, 1.0);
        return paperYears * (least + (most - least) * kinetics.position) * x * (2.0 - x);
    }
    const auto rate = plan.course.firstYearUm.find(kinetics.category);
    if (rate == plan.course.firstYearUm.end()) {
        std::vector<std::string> names;
        for (const auto& entry : plan.course.firstYearUm)
            names.push_back(entry.first);
        throw Error(ExitCode::commandLine, "--category",
                    fmt::format("'{}' is not a corrosivity category", kinetics.category),
                    fmt::format("ISO 9223 has {}", vocabulary::listed(names)));
    }
    return plan.expansion * plan.retained * metalLossUm(plan.course.exponent, rate->second, kinetics.position, years);
}

std::vector<double> layerThicknessesUm(const WeatherPlan& plan, const WeatherKinetics& kinetics, double years) {
    // Amounts are shared out as metal where a loss of metal is known, else as thickness.
    const bool byMetal = !kinetics.category.empty();
    const double unit = byMetal ? plan.expansion : 1.0;
    const auto oxidesAt = [&](double at, std::vector<double>* each) {
        double sum = 0.0;
        for (std::size_t i = 0; i < plan.oxides.size(); ++i) {
            const double t = plan.oxides[i].thicknessUm * (1.0 - std::exp(-at / plan.oxides[i].years));
            if (each)
                (*each)[i] = t;
            sum += byMetal ? t / plan.oxides[i].expansion : t;
        }
        return sum;
    };
    std::vector<double> thickness(plan.oxides.size() + plan.minerals.size(), 0.0);
    oxidesAt(years, &thickness);
    if (plan.minerals.empty())
        return thickness;
    const auto begun = [](const WeatherMineral& mineral, double at) {
        const auto& [from, to] = mineral.begins;
        const double x = std::clamp((at - from) / std::max(to - from, 1e-9), 0.0, 1.0);
        return x * x * (3.0 - 2.0 * x);
    };
    // Of what the kinetics leave to minerals, as much is there as the first of them has begun. What grows in each
    // twentieth of a year goes to the later ones by their parts at that time, and the rest to the first.
    constexpr double step = 0.05;
    double before = 0.0;
    const int steps = static_cast<int>(std::ceil(years / step - 1e-9));
    for (int i = 1; i <= steps; ++i) {
        const double now = std::min(years, i * step);
        const double allowed = patinaThicknessUm(plan, kinetics, now) / unit - oxidesAt(now, nullptr);
        const double mineral = std::max(before, begun(plan.minerals[0], now) * allowed);
        double left = mineral - before;
        for (std::size_t m = plan.minerals.size(); m-- > 1;) {
            const double part = left * plan.minerals[m].share * begun(plan.minerals[m], now);
            thickness[plan.oxides.size() + m] += part * (byMetal ? plan.minerals[m].expansion : 1.0);
            left -= part;
        }
        thickness[plan.oxides.size()] += left * (byMetal ? plan.minerals[0].expansion : 1.0);
        before = mineral;
    }
    return thickness;
}

double convertedFraction(const WeatherPlan& plan, const WeatherKinetics& kinetics, const WeatherConversion& conversion,
                         double since, double year) {
    const auto grownBy = [&](double at) {
        const std::vector<double> thickness = layerThicknessesUm(plan, kinetics, at);
        double sum = 0.0;
        for (std::size_t i = 0; i < thickness.size(); ++i) {
            const std::string& material = i < plan.oxides.size() ? plan.oxides[i].material
                                                                  : plan.minerals[i - plan.oxides.size()].material;
            if (material == conversion.from)
                sum += thickness[i];
        }
        return sum;
    };
    // What is left in a year of all that has grown until then; steps of a quarter of a year from year 0, whatever the
    // frames are, each µm counted from the middle of its step.
    const auto leftIn = [&](double at) {
        constexpr double step = 0.25;
        const int steps = static_cast<int>(std::ceil(at / step - 1e-9));
        double left = 0.0, before = 0.0;
        for (int i = 1; i <= steps; ++i) {
            const double now = std::min(at, i * step);
            const double grown = grownBy(now);
            const double passed = at - std::max(0.5 * (now + (i - 1) * step), conversion.begins);
            left += (grown - before) * std::exp2(-std::max(0.0, passed) / conversion.halfLifeYears);
            before = grown;
        }
        return left;
    };
    if (year <= conversion.begins)
        return 0.0;
    const double stock = leftIn(since) + grownBy(year) - grownBy(since);
    return stock > 0.0 ? std::clamp(1.0 - leftIn(year) / stock, 0.0, 1.0) : 0.0;
}

} // namespace patina
