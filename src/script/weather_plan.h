#pragma once
// What the weather does to a metal: layers in their order, how thick they are after how many years, and where
// (Dorsey & Hanrahan 1996, section 2.2 and figure 2; ISO 9223 and 9224 for the amounts).

#include "script/kinetics.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace patina {

/// How a layer's thickness is spread over the surface: an even part, and a pattern of growth that ages with it.
struct WeatherPattern {
    std::string model; ///< "BD", …
    int total = 10;    ///< monolayers of age at the reference year
    double even = 0.3; ///< share of the mean thickness that lies everywhere alike, 0…1
    std::string map;   ///< a map of the language that scales the thickness; empty: none
};

/// Oxides approach a thickness: t (1 - exp(-years / years_)).
struct WeatherOxide {
    std::string material;
    double thicknessUm = 0.0;
    double years = 1.0;
    WeatherPattern pattern;
    double expansion = 1.0; ///< of this material (see WeatherPlan::expansion)
};

/// Minerals share what the kinetics leave after the oxides. The first one is there on the first places after
/// `begins.first` years and on the last after `begins.second`; a later one's part of the growth rises from nothing to
/// `share` in that time.
struct WeatherMineral {
    std::string material;
    std::pair<double, double> begins{0.0, 1.0};
    double share = 1.0;
    WeatherPattern pattern;
    double expansion = 1.0; ///< of this material (see WeatherPlan::expansion)
};

/// One mineral turns into another, half of it in `halfLifeYears`.
struct WeatherConversion {
    std::string from, to;
    double halfLifeYears = 10.0;
    double begins = 0.0;
};

/// What is worn off, softest first.
struct WeatherWear {
    double umPerYear = 0.0;
    double begins = 0.0;
    std::string map;
};

/// What settles on top of all else.
struct WeatherDeposit {
    std::string material;
    double umPerYear = 0.0;
    double begins = 0.0;
    WeatherPattern pattern;
};

struct WeatherPlan {
    std::string title;
    std::string metal;
    /// Mean growth of the patina over the first 20 years (the paper's rate): least and most, often the same.
    std::optional<std::pair<double, double>> paperUmPerYear;
    /// Thickness of mineral per thickness of metal lost, of materials of which nothing better is known. Of a mixture it
    /// is 1 / sum (v / e) over the minerals' shares of its volume; parts without metal, such as binder, count as room.
    double expansion = 1.0;
    double retained = 1.0;                ///< share of it that is not washed away
    MetalKinetics course;                 ///< how the metal is lost
    std::vector<WeatherOxide> oxides;
    std::vector<WeatherMineral> minerals;
    std::vector<WeatherConversion> conversions;
    std::vector<WeatherWear> wear;
    std::vector<WeatherDeposit> deposits;
};

/// Reads data/weather/METAL_ENVIRONMENT.toml and kinetics.toml, and what the layers are mixed of from data/materials.
/// \throws Error (command line) where there is none for the two; ScriptError with every fault of the files
WeatherPlan readWeatherPlan(const std::filesystem::path& dataFolder, const std::string& environment,
                            const std::string& metal);

/// Environments and metals for which there are plans, as "copper_marine".
std::vector<std::string> weatherPlans(const std::filesystem::path& dataFolder);

/// Sun and rain of another latitude: `exposure` and `wetness` in the plan's maps get the argument.
/// \throws Error (command line) beyond 90°
void setLatitude(WeatherPlan& plan, double degrees);

/// How much patina there is after some years.
struct WeatherKinetics {
    std::string category;  ///< C1 … CX of ISO 9223; empty: the paper's rate
    double position = 0.5; ///< within the range: 0 its least, 1 its most; of a category geometrically between them
};

/// Whether the plan's paper rate is a range, of which least and most can be asked.
bool hasPaperRange(const WeatherPlan& plan);

/// Mean thickness of the whole patina, µm, if all of it took the plan's expansion. The paper's rate r: 20 r (2x - x²), x = years / 20, at most 1: fastest at
/// first, nothing after 20 years. ISO 9224: expansion · retained · r years^b, along the tangent after 20 years.
/// \throws Error (command line) for a category without a rate
double patinaThicknessUm(const WeatherPlan& plan, const WeatherKinetics& kinetics, double years);

/// The same, shared out: first the oxides, then the minerals, in the plan's order. Never falls with the years. The
/// paper's rate is a thickness, so the layers add up to it; a category's loss is metal, of which each layer holds its
/// thickness over its own expansion, together expansion⁻¹ patinaThicknessUm().
std::vector<double> layerThicknessesUm(const WeatherPlan& plan, const WeatherKinetics& kinetics, double years);

/// The fraction of what there is of conversion.from that turns in the years since .. year: half of every µm in a half-life
/// from when it grew (or from conversion.begins), so that many short frames and one long one leave the same.
double convertedFraction(const WeatherPlan& plan, const WeatherKinetics& kinetics, const WeatherConversion& conversion,
                         double since, double year);

} // namespace patina
