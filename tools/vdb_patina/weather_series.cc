#include "weather_series.h"

#include "data_folder.h"
#include "existing_volume.h"
#include "outputs.h"
#include "script_run.h"
#include "time_lapse.h"
#include "view_input.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "render/film.h"

#include <fmt/format.h>

#include <optional>

namespace patina::tool {

namespace {

namespace fs = std::filesystem;

// Whether an earlier run has made this frame, from the same script.
bool isDone(const fs::path& folder, const std::string& name, const std::string& script) {
    const fs::path scriptFile = folder / (name + ".patina");
    return fs::exists(folder / "report.json") && fs::exists(folder / (name + ".vdb")) && fs::exists(scriptFile) &&
           readTextFile(scriptFile.string()) == script;
}

// What the frames have in common: the model, what a run leaves to the next, and the view (found by the first frame that
// is run).
struct Series {
    std::optional<Task> task;
    RunSession session;
    std::shared_ptr<const View> view;
};

void runFrame(const WeatherFrame& frame, const fs::path& folder, const WeatherSeries& series, Series& common,
              const Options& given, bool withMaps, const MaterialLibrary& materials, Console& console) {
    console.startOver();
    Options options = given;
    options.output = folder.string();
    options.report.clear();
    options.bakeMaps = withMaps;
    fs::create_directories(folder);
    const fs::path scriptFile = folder / (series.environment + ".patina");
    writeTextFile(scriptFile, frame.script);
    if (common.task)
        nextScript(*common.task, scriptFile.string(), materials, options, console);
    else
        common.task = prepareTask(scriptFile.string(), series.model, materials, options, console);
    const Task& task = *common.task;
    checkBudget(task, options, console);
    if (!common.view && options.pictureSize > 0)
        common.view = std::make_shared<const View>(stillViewOf(options, task.model));
    options.view = common.view;
    reportFile(options, folder);
    RunOptions run = runOptionsOf(task, options);
    run.session = &common.session;
    RunResult result = runProgram(task.program, task.model.surface, materials, run, console);
    if (result.interrupted)
        throw Interrupted();
    warnAboutClamping(result, console);
    writeResults(task, result, nlohmann::ordered_json::array(), materials, options, folder, console);
    common.session.keep(folder / (task.program.name + ".vdb"), std::move(*result.volume));
}

// Where all frames were done by an earlier run.
std::shared_ptr<const View> viewOfFrame(const fs::path& volume, const std::string& model, const Options& options,
                                        Console& console) {
    return std::make_shared<const View>(
        stillViewOf(options, loadExisting(volume.string(), model, options, console).model));
}

} // namespace

std::vector<LabelledImage> runWeatherSeries(const WeatherSeries& series, const Options& options, const fs::path& folder,
                                            Console& console) {
    const MaterialLibrary materials = MaterialLibrary::load(findDataFolder());
    std::vector<LabelledImage> pictures;
    Series common;
    common.view = options.view;
    TimeLapse lapse{series.model, series.environment, {}, series.film ? series.between : 0, series.framesPerSecond};
    for (std::size_t i = 0; i < series.frames.size(); ++i) {
        const WeatherFrame& frame = series.frames[i];
        const fs::path here = folder / frame.folder;
        const bool withMaps = series.maps == "all" || (series.maps == "last" && i + 1 == series.frames.size());
        console.notice(fmt::format("year {:g}: frame {} of {}", frame.year, i + 1, series.frames.size()));
        if (options.resume && isDone(here, series.environment, frame.script)) {
            console.notice("done by an earlier run");
        } else {
            try {
                runFrame(frame, here, series, common, options, withMaps, materials, console);
            } catch (const Interrupted&) {
                throw Error(ExitCode::interrupted, "weather",
                            fmt::format("interrupted in year {:g}; {} of {} frames are finished and saved", frame.year,
                                        i, series.frames.size()),
                            "the same command with --resume goes on from there");
            }
        }
        lapse.volumes.push_back(here / (series.environment + ".vdb"));
        if (options.pictureSize > 0) {
            const fs::path picture = here / "preview.png";
            // Numbered for programs that read image sequences.
            fs::path numbered = pictureNumbered(folder, series.environment, numberOfFrame(i, lapse.between));
            fs::copy_file(picture, numbered, fs::copy_options::overwrite_existing);
            if (options.exr && fs::exists(here / "preview.exr"))
                fs::copy_file(here / "preview.exr", numbered.replace_extension(".exr"),
                              fs::copy_options::overwrite_existing);
            pictures.push_back(
                {readPng(picture), fmt::format("{:g} year{}", frame.year, frame.year == 1.0 ? "" : "s")});
        }
    }
    if (series.film && options.pictureSize > 0) {
        Options shown = options;
        shown.view = common.view ? common.view : viewOfFrame(lapse.volumes.front(), series.model, options, console);
        writeTimeLapse(lapse, shown, folder, console);
    }
    return pictures;
}

} // namespace patina::tool
