#pragma once
// One function per command: adds it to the command line and sets `action` to run it.

#include "options.h"

#include <CLI/CLI.hpp>

#include <functional>

namespace patina::tool {

class Console;

/// What a command does once the command line has been read; gets the console to talk through.
using Action = std::function<void(Console&)>;

void addRunCommand(CLI::App& app, Options& options, Action& action);
void addCheckCommand(CLI::App& app, Options& options, Action& action);
void addBakeCommand(CLI::App& app, Options& options, Action& action);
void addRenderCommand(CLI::App& app, Options& options, Action& action);
void addProbeCommand(CLI::App& app, Options& options, Action& action);
void addInfoCommand(CLI::App& app, Options& options, Action& action);
void addMakeCommand(CLI::App& app, Options& options, Action& action);
void addMaterialsCommand(CLI::App& app, Options& options, Action& action);
void addWeatherCommand(CLI::App& app, Options& options, Action& action);
void addFigureCommand(CLI::App& app, Options& options, Action& action);
void addSliceCommand(CLI::App& app, Options& options, Action& action);
void addContactSheetCommand(CLI::App& app, Options& options, Action& action);

} // namespace patina::tool
