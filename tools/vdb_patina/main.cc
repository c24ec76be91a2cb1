// The vdb-patina program: reads the command line, runs one command, turns errors into words and exit codes.

#include "commands.h"
#include "console.h"

#include "base/errors.h"
#include "base/names.h"
#include "volume/vdb_file.h"

#include <ImfThreading.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <csignal>
#include <cstdlib>
#include <memory>
#include <new>
#include <optional>
#include <thread>

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

int exitStatus(ExitCode code) { return static_cast<int>(code); }

std::string suggestCommand(const CLI::App& app, int argc, char** argv) {
    if (argc < 2 || argv[1][0] == '-')
        return {};
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(command->get_name());
    for (const std::string& name : names)
        if (name == argv[1])
            return {};
    const std::string hint = didYouMean(argv[1], names);
    return hint.empty() ? hint : "\n" + hint;
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
        action(console);
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
    CLI::App app{"Weathers metal: grows, paints, erodes and polishes thin layers on a surface, and works out their light."};
    app.name("vdb-patina");
    app.set_version_flag("--version", "vdb-patina " PATINA_VERSION);
    app.require_subcommand(1);
    app.get_formatter()->column_width(34);

    Options options;
    Action action;
    addRunCommand(app, options, action);
    addBakeCommand(app, options, action);
    addRenderCommand(app, options, action);
    addProbeCommand(app, options, action);
    addInfoCommand(app, options, action);
    addCheckCommand(app, options, action);
    addMaterialsCommand(app, options, action);
    addMakeCommand(app, options, action);
    addContactSheetCommand(app, options, action);

    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp& help) {
        return app.exit(help);
    } catch (const CLI::CallForAllHelp& help) {
        return app.exit(help);
    } catch (const CLI::CallForVersion& version) {
        return app.exit(version);
    } catch (const CLI::ParseError& wrong) {
        fmt::print(stderr, "error: {}{}\nvdb-patina --help tells more.\n", wrong.what(), suggestCommand(app, argc, argv));
        return exitStatus(ExitCode::commandLine);
    }
    return runAction(action, options);
}
