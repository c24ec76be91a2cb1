// The vdb-patina program: reads the command line, runs one command, turns errors into words and exit codes.

#include "command_line.h"
#include "commands.h"
#include "console.h"

#include "base/errors.h"
#include "volume/vdb_file.h"

#include <ImfThreading.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <new>
#include <optional>
#include <thread>
#include <vector>

namespace {

using namespace patina;
using namespace patina::tool;

// A signal handler can reach nothing but a global.
Progress* interruptible = nullptr;

extern "C" void onInterrupt(int signal) {
    if (interruptible)
        interruptible->cancel();
    // A second Ctrl-C ends the program at once.
    std::signal(signal, SIG_DFL);
}

int exitStatus(ExitCode code) {
    return static_cast<int>(code);
}

int runAction(const Action& action, const Options& options) {
    std::optional<tbb::global_control> limit;
    const int threads = options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());
    if (options.threads > 0)
        limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    Imf::setGlobalThreadCount(threads > 1 ? threads : 0);
    OIIO::attribute("threads", threads);
    initializeVolumes();

    Console console(options);
    interruptible = &console;
    std::signal(SIGINT, onInterrupt);
    std::signal(SIGTERM, onInterrupt);
    int status = exitStatus(ExitCode::done);
    try {
        // In an arena of its own: the default one has no more threads than the machine has cores.
        tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
        arena.execute([&] { action(console); });
    } catch (const Interrupted& stop) {
        console.error(stop.what());
        status = exitStatus(stop.code());
    } catch (const ScriptError& errors) {
        // Diagnostics carry their own severity and place.
        std::fputs((std::string(errors.what()) + "\n").c_str(), stderr);
        status = exitStatus(errors.code());
    } catch (const Error& failure) {
        console.error(failure.what());
        status = exitStatus(failure.code());
    } catch (const std::bad_alloc&) {
        console.error("out of memory (use larger voxels or smaller maps; `vdb-patina check` tells what a run needs)");
        status = exitStatus(ExitCode::failed);
    } catch (const std::exception& failure) {
        console.error(failure.what());
        status = exitStatus(ExitCode::failed);
    }
    interruptible = nullptr;
    return status;
}

} // namespace

int main(int argc, char** argv) {
    CLI::App app{
        "Weathers metal: grows, paints, erodes and polishes thin layers on a surface, and works out their light."};
    app.name("vdb-patina");
    app.formatter(helpLayout()); // before the commands, which inherit it
    app.set_help_flag("-h,--help", "Print this and end; behind a command: its own options");
    app.set_version_flag("--version", "vdb-patina " PATINA_VERSION, "Print the version and end");
    app.require_subcommand(1);

    Options options;
    Action action;
    addRunCommand(app, options, action);
    addBakeCommand(app, options, action);
    addRenderCommand(app, options, action);
    addProbeCommand(app, options, action);
    addWeatherCommand(app, options, action);
    addFigureCommand(app, options, action);
    addSliceCommand(app, options, action);
    addInfoCommand(app, options, action);
    addCheckCommand(app, options, action);
    addMaterialsCommand(app, options, action);
    addMakeCommand(app, options, action);
    addContactSheetCommand(app, options, action);

    for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        command->group("Commands");

    std::vector<std::string> words(argv + 1, argv + argc);
    if (!words.empty() && words.front() == "help") // `help run` is `run --help`
        std::rotate(words.begin(), words.begin() + 1, words.end()), words.back() = "--help";
    try {
        app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    } catch (const CLI::CallForHelp& help) {
        return app.exit(help);
    } catch (const CLI::CallForAllHelp& help) {
        return app.exit(help);
    } catch (const CLI::CallForVersion& version) {
        return app.exit(version);
    } catch (const CLI::ParseError& wrong) {
        fmt::print(stderr, "error: {}\n{}\n", describeParseError(wrong, app, words), whereHelpIs(app));
        return exitStatus(ExitCode::commandLine);
    }
    return runAction(action, options);
}
