#pragma once
// All that the program says: results to stdout, everything else to stderr.

#include "base/errors.h"
#include "base/progress.h"
#include "options.h"

#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace spdlog {
class logger;
}

namespace patina::tool {

/// Progress as a bar, lines or JSON, and messages by spdlog. Keeps the time of every stage for the report.
class Console : public Progress {
  public:
    explicit Console(const Options& options);
    ~Console() override;

    void begin(const std::string& stage) override;
    void update(double fraction) override;
    void end() override;

    void info(const std::string& text);   ///< said with -v
    void notice(const std::string& text); ///< said unless -q
    void warning(const std::string& text);
    /// A finding with a place of its own, said as it stands: "file:3:1: warning: …".
    void warning(const Diagnostic& finding);
    void error(const std::string& text);
    /// A result: to stdout.
    void result(const std::string& text);

    struct Stage {
        std::string name;
        double seconds;
    };
    /// Forgets the stages and warnings so far: what follows has a report of its own.
    void startOver();
    const std::vector<Stage>& stages() const { return stages_; }
    const std::vector<std::string>& warnings() const { return warnings_; }

  private:
    void draw(double fraction);
    void clearBar();

    ProgressStyle style_;
    std::shared_ptr<spdlog::logger> log_;
    std::string stage_;
    std::chrono::steady_clock::time_point start_;
    std::chrono::steady_clock::time_point drawn_;
    std::vector<Stage> stages_;
    std::vector<std::string> warnings_;
    bool barShown_ = false;
};

} // namespace patina::tool
