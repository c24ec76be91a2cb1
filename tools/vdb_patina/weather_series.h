#pragma once
// The frames of a history of weather, each going on from the one before.

#include "console.h"
#include "options.h"

#include "render/contact_sheet.h"
#include "script/weather_script.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patina::tool {

struct WeatherSeries {
    std::string model;         ///< file, or a shape of `make`
    std::string environment;   ///< names scripts and volumes
    std::string maps = "last"; ///< of which frames maps are baked: all, last, none
    bool film = false;         ///< pictures between the frames, and a film of all
    int between = 0;           ///< pictures between one frame and the next
    double framesPerSecond = 12.0;
    std::vector<WeatherFrame> frames;
};

/// Runs the frames in folders of their own below `folder`. Pictures are numbered there as a sequence besides,
/// all from one view and under one light, unless options.view gives another.
/// With options.resume, frames that are there and were made by the same script are kept.
/// \return the pictures, labelled with their years; empty where the options ask for none
/// \throws Error (interrupted) naming what is finished
std::vector<LabelledImage> runWeatherSeries(const WeatherSeries& series, const Options& options,
                                            const std::filesystem::path& folder, Console& console);

} // namespace patina::tool
