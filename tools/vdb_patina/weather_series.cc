#include "weather_series.h"

#include "data_folder.h"
#include "outputs.h"
#include "script_run.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "render/film.h"

#include <fmt/format.h>

namespace patina::tool {

namespace {

namespace fs = std::filesystem;

// Whether an earlier run has made this frame, from the same script.
bool isDone(const fs::path& folder, const std::string& name, const std::string& script) {
    const fs::path scriptFile = folder / (name + ".patina");
    return fs::exists(folder / "report.json") && fs::exists(folder / (name + ".vdb")) && fs::exists(scriptFile) &&
           readTextFile(scriptFile.string()) == script;
}

void runFrame(const WeatherFrame& frame, const fs::path& folder, const WeatherSeries& series, const Options& given,
              bool withMaps, const MaterialLibrary& materials, Console& console) {
    Options options = given;
    options.output = folder.string();
    options.report.clear();
    options.bakeMaps = withMaps;
    fs::create_directories(folder);
    const fs::path scriptFile = folder / (series.environment + ".patina");
    writeTextFile(scriptFile, frame.script);
    const Task task = prepareTask(scriptFile.string(), series.model, materials, options, console);
    checkBudget(task, options, console);
    reportFile(options, folder);
    RunResult result = runProgram(task.program, task.model.surface, materials, runOptionsOf(task, options), console);
    if (result.interrupted)
        throw Interrupted();
    warnAboutClamping(result, console);
    writeResults(task, result, nlohmann::ordered_json::array(), materials, options, folder, console);
}

} // namespace

std::vector<LabelledImage> runWeatherSeries(const WeatherSeries& series, const Options& options, const fs::path& folder,
                                            Console& console) {
    const MaterialLibrary materials = MaterialLibrary::load(findDataFolder());
    std::vector<LabelledImage> pictures;
    for (std::size_t i = 0; i < series.frames.size(); ++i) {
        const WeatherFrame& frame = series.frames[i];
        const fs::path here = folder / frame.folder;
        const bool withMaps = series.maps == "all" || (series.maps == "last" && i + 1 == series.frames.size());
        console.notice(fmt::format("year {:g}: frame {} of {}", frame.year, i + 1, series.frames.size()));
        if (options.resume && isDone(here, series.environment, frame.script)) {
            console.notice("done by an earlier run");
        } else {
            try {
                runFrame(frame, here, series, options, withMaps, materials, console);
            } catch (const Interrupted&) {
                throw Error(ExitCode::interrupted, "weather",
                            fmt::format("interrupted in year {:g}; {} of {} frames are finished and saved", frame.year,
                                        i, series.frames.size()),
                            "the same command with --resume goes on from there");
            }
        }
        if (options.pictureSize > 0) {
            const fs::path picture = here / "preview.png";
            // Numbered for programs that read image sequences.
            fs::copy_file(picture, folder / fmt::format("{}_{:04}.png", series.environment, i + 1),
                          fs::copy_options::overwrite_existing);
            pictures.push_back(
                {readPng(picture), fmt::format("{:g} year{}", frame.year, frame.year == 1.0 ? "" : "s")});
        }
    }
    return pictures;
}

} // namespace patina::tool
