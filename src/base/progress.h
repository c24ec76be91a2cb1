#pragma once
// One small object for progress and cancellation, passed into everything that takes time.

#include <atomic>
#include <string>

namespace patina {

/// Receives progress and says whether to go on. The base class reports nothing and never cancels.
/// `begin`, `update`, `end` are called from one thread; `cancelled` and `checkpoint` from any.
class Progress {
  public:
    virtual ~Progress() = default;

    /// A stage starts, e.g. "coat cuprite_2". Stages do not nest.
    virtual void begin(const std::string& stage);
    /// fraction of the running stage, 0…1.
    virtual void update(double fraction);
    virtual void end();

    /// Asks the work to stop at its next checkpoint. Safe in a signal handler.
    void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
    bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }
    /// \throws Interrupted when cancelled.
    void checkpoint() const;

  private:
    std::atomic<bool> cancelled_{false};
};

/// begin() now, end() when it goes out of scope.
class ProgressStage {
  public:
    ProgressStage(Progress& progress, const std::string& stage) : progress_(progress) { progress_.begin(stage); }
    ~ProgressStage() { progress_.end(); }
    ProgressStage(const ProgressStage&) = delete;
    ProgressStage& operator=(const ProgressStage&) = delete;

  private:
    Progress& progress_;
};

} // namespace patina
