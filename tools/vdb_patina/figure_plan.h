#pragma once
// What a figure shows: panels made by scripts, histories of weather, and how they are laid out (data/figures).

#include "options.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace patina::tool {

/// Options that a figure sets; those that are not set are the command line's.
struct FigureOptions {
    std::optional<int> voxels, resolution, picture, samples;
    std::optional<double> exaggeration, azimuth, elevation;
    std::optional<std::string> regionAt; ///< "x,y,z,size"

    /// These, and `outer` where these are not set.
    FigureOptions over(const FigureOptions& outer) const;
    void apply(Options& options) const;
};

/// Cells of the figure's grid, from 0 at the top left.
struct FigurePlace {
    int row = 0, column = 0;
    int rows = 1, columns = 1;
};

struct FigurePanel {
    enum class Kind {
        picture, ///< of the object
        slice,   ///< a core sample
        map,     ///< one of the baked maps, over the UV square
        curves,  ///< the script's curves over the years
        stack,   ///< a graph of the stack along one normal
        diagram, ///< the stages of the weather in several environments, with the minerals they are of
        stages,  ///< what the weather lays down in an environment, over the years
    };
    Kind kind = Kind::picture;
    std::string label;
    std::string script;           ///< the text
    std::string name;             ///< of the script
    std::string model;            ///< file, or a shape of `make`
    std::vector<std::string> set; ///< NAME=VALUE
    FigureOptions options;
    std::string map;              ///< kind map: the map's name
    std::string at, along, width; ///< kind slice, as on the command line
    double stretch = 0.0;
    bool byId = false;
    bool inPlace = false;
    std::string environment;        ///< kind stages
    double years = 30.0;            ///< kind stages
    std::vector<std::string> environments, key; ///< kind diagram: its columns, and materials to name below
    std::optional<FigurePlace> place;           ///< of all panels or of none
    bool continues = false;   ///< goes on from the volume of the panel before: `open` in place of the script's `new`
    bool replaceable = false; ///< --model puts another model in
};

struct FigureSeries {
    std::string environment;
    std::string model;
    double lastYear = 30.0;
    int frames = 6;
    FigureOptions options;
};

struct FigurePlan {
    std::string title;
    int columns = 0;
    std::vector<FigureSeries> series; ///< each in rows of its own, before the panels
    std::vector<FigurePanel> panels;

    bool isPlaced() const { return !panels.empty() && panels.front().place.has_value(); }
};

/// Numbers of the figures that there are.
std::vector<int> figureNumbers(const std::filesystem::path& dataFolder);

/// Reads data/figures/figure_NN.toml. \throws Error (command line) where there is no such figure; ScriptError with all
/// faults of the file
FigurePlan readFigurePlan(const std::filesystem::path& dataFolder, int number);

} // namespace patina::tool
