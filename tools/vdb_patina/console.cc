#include "console.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace patina::tool {

namespace {

ProgressStyle chosen(const Options& options) {
    if (options.quiet && options.progress == ProgressStyle::automatic)
        return ProgressStyle::none;
    if (options.progress == ProgressStyle::automatic)
        return ::isatty(STDERR_FILENO) ? ProgressStyle::bar : ProgressStyle::plain;
    if (options.progress == ProgressStyle::bar && !::isatty(STDERR_FILENO))
        return ProgressStyle::plain;
    return options.progress;
}

void writeError(const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

} // namespace

Console::Console(const Options& options) : style_(chosen(options)) {
    log_ = std::make_shared<spdlog::logger>("vdb-patina", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
    log_->set_pattern("%^%l%$: %v");
    log_->set_level(options.quiet ? spdlog::level::warn : options.verbose ? spdlog::level::debug : spdlog::level::info);
}

Console::~Console() {
    clearBar();
}

void Console::begin(const std::string& stage) {
    stage_ = stage;
    start_ = drawn_ = std::chrono::steady_clock::now();
    if (style_ == ProgressStyle::bar)
        draw(0.0);
    else if (style_ == ProgressStyle::json)
        writeError(nlohmann::json({{"stage", stage_}, {"state", "begin"}}).dump() + "\n");
}

void Console::update(double fraction) {
    const auto now = std::chrono::steady_clock::now();
    if (now - drawn_ < std::chrono::milliseconds(100))
        return;
    drawn_ = now;
    if (style_ == ProgressStyle::bar)
        draw(fraction);
    else if (style_ == ProgressStyle::json)
        writeError(nlohmann::json({{"stage", stage_}, {"state", "running"}, {"fraction", fraction}}).dump() + "\n");
}

void Console::startOver() {
    stages_.clear();
    warnings_.clear();
}

void Console::end() {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    stages_.push_back({stage_, seconds});
    clearBar();
    if (style_ == ProgressStyle::plain || style_ == ProgressStyle::bar)
        writeError(fmt::format("{:8.2f} s  {}\n", seconds, stage_));
    else if (style_ == ProgressStyle::json)
        writeError(nlohmann::json({{"stage", stage_}, {"state", "end"}, {"seconds", seconds}}).dump() + "\n");
}

void Console::draw(double fraction) {
    constexpr int width = 24;
    const int full = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * width);
    writeError(
        fmt::format("\r\033[K[{}{}] {}", std::string(full, '#'), std::string(width - full, '.'), stage_.substr(0, 48)));
    barShown_ = true;
}

void Console::clearBar() {
    if (barShown_)
        writeError("\r\033[K");
    barShown_ = false;
}

void Console::info(const std::string& text) {
    clearBar();
    log_->debug(text);
}

void Console::notice(const std::string& text) {
    clearBar();
    log_->info(text);
}

void Console::warning(const std::string& text) {
    clearBar();
    warnings_.push_back(text);
    log_->warn(text);
}

void Console::warning(const Diagnostic& finding) {
    clearBar();
    warnings_.push_back(finding.text());
    writeError(finding.text() + "\n");
}

void Console::error(const std::string& text) {
    clearBar();
    log_->error(text);
}

void Console::result(const std::string& text) {
    clearBar();
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fputc('\n', stdout);
    std::fflush(stdout);
}

} // namespace patina::tool
