#pragma once
// How the command line reads: the help's layout, checks whose errors are sentences, what to say to a line that is
// wrong.

#include <CLI/CLI.hpp>

#include <memory>
#include <string>
#include <vector>

namespace patina::tool {

/// The layout of --help: an option, what it takes, what it does.
std::shared_ptr<CLI::FormatterBase> helpLayout();

/// A number from lowest to highest.
CLI::Validator numberWithin(double lowest, double highest);
/// A whole number from lowest to highest.
CLI::Validator wholeNumberWithin(long long lowest, long long highest);
/// A finite number above 0.
CLI::Validator numberAboveZero();
/// One of some words, with the one that was probably meant.
CLI::Validator oneOf(std::vector<std::string> words);

/// What was wrong with a command line, and which command or option was probably meant.
std::string describeParseError(const CLI::ParseError& error, const CLI::App& app,
                               const std::vector<std::string>& words);
/// The line that follows it.
std::string whereHelpIs(const CLI::App& app);

} // namespace patina::tool
