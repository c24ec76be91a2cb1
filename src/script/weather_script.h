#pragma once
// Writes the scripts that let the weather do its work: one for each moment, each going on from the last.

#include "script/weather_plan.h"

#include <string>
#include <vector>

namespace patina {

/// One moment of a history.
struct WeatherFrame {
    double year = 0.0;
    std::string folder; ///< "year_06": where its results go, beside those of the other frames
    std::string script; ///< readable, and complete but for the volume it opens
};

/// \param years  increasing, the first at least 0; a first year above 0 begins with bare metal too
/// \param name   of the scripts and volumes: each frame but the first opens "../FOLDER/NAME.vdb" of the one before
/// Layers come on top as they begin; those that are there thicken where they lie. A frame's patterns are later steps of
/// the same growth, so nothing that was there is elsewhere in the next frame.
/// \throws Error (command line) for years out of order
std::vector<WeatherFrame> weatherScripts(const WeatherPlan& plan, const WeatherKinetics& kinetics,
                                         const std::vector<double>& years, const std::string& name);

} // namespace patina
