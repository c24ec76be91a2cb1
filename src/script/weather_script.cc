#include "script/weather_script.h"

#include "base/errors.h"
#include "operators/growth/grow.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace patina {

namespace {

// The year at which a layer's pattern has reached its full age. It does not depend on the frames asked for.
constexpr double referenceYear = 30.0;
// Films thinner than a tenth of a nanometre are left for the next frame.
constexpr double leastUm = 1e-4;

// Mean factor of a pattern at its steps, relative to its last one. Growing the reference plane takes a third of a
// second for an old pattern, so means are taken at four moments and lie on straight lines between them.
class PatternMeans {
  public:
    explicit PatternMeans(const WeatherPattern& pattern) : total_(pattern.total) {
        GrowthOptions options;
        options.model = *growthModelNamed(pattern.model);
        options.total = pattern.total;
        options.step = pattern.total;
        const GrowthScale last = expectedScale(options);
        for (std::size_t i = 1; i < means_.size(); ++i) {
            options.step = pattern.total * double(i) / double(means_.size() - 1);
            means_[i] = (i + 1 == means_.size() ? last : expectedScale(options)).mean / last.top();
        }
    }

    double at(int step) const {
        const double x = double(step) / total_ * double(means_.size() - 1);
        const std::size_t i = std::min(static_cast<std::size_t>(x), means_.size() - 2);
        return means_[i] + (x - double(i)) * (means_[i + 1] - means_[i]);
    }

  private:
    int total_;
    std::array<double, 5> means_{};
};

// One layer through the years: how much of it lies evenly, and how old its pattern is.
class GrowingLayer {
  public:
    GrowingLayer(std::string material, const WeatherPattern& pattern, double referenceUm)
        : material_(std::move(material)), pattern_(pattern), means_(pattern) {
        const double full = means_.at(pattern.total);
        amplitude_ = full > 0.0 ? (1.0 - pattern.even) * referenceUm / full : 0.0;
    }

    const std::string& material() const { return material_; }
    bool present() const { return patternUm_ > 0.0 || evenUm_ > 0.0; }

    // The statement that brings the mean thickness to `um`; empty where nothing is to be done.
    //
    // The even part is a fixed share and the step of the pattern a function of `um` alone, so that neither depends on
    // the frames that lie between; the pattern's amount makes the mean exact. A step is begun with the first of its
    // growth and thickens until it is full.
    std::string growTo(double um, const std::string& word) {
        const double more = um - evenUm_ - patternUm_;
        if (!(more > leastUm))
            return {};
        const bool isPatterned = amplitude_ > leastUm;
        double even = isPatterned ? std::clamp(pattern_.even * um - evenUm_, 0.0, more) : more;
        if (even <= leastUm)
            even = 0.0;
        else if (more - even <= leastUm)
            even = more;
        double most = even;
        std::string map;
        if (even < more) {
            const bool isFull = patternUm_ > amplitude_ * means_.at(pattern_.total) - leastUm;
            const int step = std::max(step_, stepFor((1.0 - pattern_.even) * um));
            const int since = isFull ? 0 : step > step_ ? step_ : step - 1;
            most += (more - even) / (means_.at(step) - means_.at(since));
            map = fmt::format("texture({}(rate=linear, step={}, {}total={}) of full)", pattern_.model, step,
                              since > 0 ? fmt::format("since={}, ", since) : "", pattern_.total);
            if (even > 0.0)
                map = fmt::format("mix({:.4g}, 1, {})", even / most, map);
            patternUm_ += more - even;
            step_ = step;
        }
        evenUm_ += even;
        if (!pattern_.map.empty())
            map += (map.empty() ? "" : " * ") + pattern_.map;
        return fmt::format("{} {} {:.4g}{}{} as {};", word, material_, most, map.empty() ? "" : " ", map, material_);
    }

  private:
    // The first step whose pattern is `um` thick.
    int stepFor(double um) const {
        int step = 1;
        while (step < pattern_.total && amplitude_ * means_.at(step) < um - 1e-9)
            ++step;
        return step;
    }

    std::string material_;
    WeatherPattern pattern_;
    PatternMeans means_;
    double amplitude_ = 0.0; // µm at factor 1
    double evenUm_ = 0.0, patternUm_ = 0.0;
    int step_ = 0;
};

std::string yearText(double year) {
    return fmt::format("{:g}", year);
}

std::string folderOf(double year) {
    // Sorted by name they are sorted by year.
    const double whole = std::floor(year);
    std::string text = fmt::format("year_{:03.0f}", whole);
    if (year > whole)
        text += fmt::format("{:.3f}", year - whole).substr(1);
    return text;
}

std::string amountText(const WeatherPlan& plan, const WeatherKinetics& kinetics, double year) {
    const std::vector<double> layers = layerThicknessesUm(plan, kinetics, year);
    const double um = std::accumulate(layers.begin(), layers.end(), 0.0);
    if (kinetics.category.empty())
        return fmt::format("{:.3g} um, at the paper's rate of {:g} um a year, which ends after 20 years", um,
                           patinaThicknessUm(plan, kinetics, 20.0) / 20.0);
    return fmt::format("{:.3g} um, by ISO 9223 category {} (at {:.0f} % of its range) and ISO 9224, which let {:.3g} um "
                       "of {} corrode: {:.0f} % of it is not washed away and swells into minerals",
                       um, kinetics.category, 100.0 * kinetics.position,
                       patinaThicknessUm(plan, kinetics, year) / (plan.expansion * plan.retained), plan.metal,
                       100.0 * plan.retained);
}

} // namespace

std::vector<WeatherFrame> weatherScripts(const WeatherPlan& plan, const WeatherKinetics& kinetics,
                                         const std::vector<double>& years, const std::string& name) {
    for (std::size_t i = 0; i < years.size(); ++i)
        if (!(years[i] >= 0.0) || !std::isfinite(years[i]) || (i > 0 && years[i] <= years[i - 1]))
            throw Error(ExitCode::commandLine, "--years", "years must increase and begin at 0 or later");

    const std::vector<double> reference = layerThicknessesUm(plan, kinetics, referenceYear);
    std::vector<GrowingLayer> layers;
    for (std::size_t i = 0; i < plan.oxides.size(); ++i)
        layers.emplace_back(plan.oxides[i].material, plan.oxides[i].pattern, reference[i]);
    for (std::size_t i = 0; i < plan.minerals.size(); ++i)
        layers.emplace_back(plan.minerals[i].material, plan.minerals[i].pattern, reference[plan.oxides.size() + i]);
    std::vector<GrowingLayer> deposits;
    for (const WeatherDeposit& deposit : plan.deposits)
        deposits.emplace_back(deposit.material, deposit.pattern,
                              deposit.umPerYear * std::max(1.0, referenceYear - deposit.begins));

    std::vector<WeatherFrame> frames;
    double since = 0.0;
    for (const double year : years) {
        WeatherFrame frame;
        frame.year = year;
        frame.folder = folderOf(year);
        std::string text = fmt::format("# {}, year {}", plan.title, yearText(year));
        text += frames.empty() ? ".\n" : fmt::format(" (going on from year {}).\n", yearText(since));
        text += fmt::format("# The patina is {}.\n", amountText(plan, kinetics, year));
        text += "# A thickness is the layer's mean times what its pattern and its place ask for.\n\n";
        text += frames.empty() ? fmt::format("new {};\n", plan.metal)
                               : fmt::format("open \"../{}/{}.vdb\";\n", frames.back().folder, name);

        const std::vector<double> thickness = layerThicknessesUm(plan, kinetics, year);
        for (std::size_t i = 0; i < layers.size(); ++i) {
            const bool present = layers[i].present();
            std::string statement = layers[i].growTo(thickness[i], present ? "grow" : "coat");
            // What rain has worn off here and there comes again.
            if (present && !statement.empty())
                statement.insert(statement.rfind(" as "), " everywhere");
            if (!statement.empty())
                text += statement + "\n";
        }
        for (const WeatherConversion& conversion : plan.conversions) {
            const auto isPresent = [&](const GrowingLayer& layer) {
                return layer.material() == conversion.from && layer.present();
            };
            if (std::none_of(layers.begin(), layers.end(), isPresent))
                continue;
            const double fraction = convertedFraction(plan, kinetics, conversion, since, year);
            if (fraction > 1e-4)
                text += fmt::format("convert {} to {} {:.4g};\n", conversion.from, conversion.to, fraction);
        }
        // What settles lies on top, also where minerals have grown over earlier dirt, and is worn off first. So wear of
        // the years before anything settled comes before it, and the rest behind it, as in many short frames.
        double settles = std::numeric_limits<double>::infinity();
        for (const WeatherDeposit& deposit : plan.deposits)
            settles = std::min(settles, deposit.begins);
        const auto wearOff = [&](double from, double to) {
            for (const WeatherWear& wear : plan.wear) {
                const double passed = to - std::max(from, wear.begins);
                if (passed > 0.0)
                    text += fmt::format("erode {:.4g}{} by hardness;\n", wear.umPerYear * passed,
                                        wear.map.empty() ? "" : " " + wear.map);
            }
        };
        wearOff(since, std::min(year, settles));
        for (std::size_t i = 0; i < deposits.size(); ++i) {
            const double um = plan.deposits[i].umPerYear * std::max(0.0, year - plan.deposits[i].begins);
            const std::string statement = deposits[i].growTo(um, "coat");
            if (!statement.empty())
                text += statement + "\n";
        }
        wearOff(std::max(since, settles), year);
        text += "render maps;\n";
        frame.script = std::move(text);
        frames.push_back(std::move(frame));
        since = year;
    }
    return frames;
}

} // namespace patina
