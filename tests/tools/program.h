#pragma once
// Starts the real vdb-patina and keeps apart what it says on stdout and stderr.

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace patina::test {

/// A folder of its own for a test, removed with it.
class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    /// Writes a file into it. \return its path
    std::string file(const std::string& name, const std::string& content) const;
    std::string at(const std::string& name) const { return (path_ / name).string(); }

  private:
    std::filesystem::path path_;
};

struct Outcome {
    int exitCode = -1; ///< -1 where a signal ended it
    int signal = 0;
    std::string out;
    std::string err;

    bool saysOnError(const std::string& text) const { return err.find(text) != std::string::npos; }
    bool saysOnOutput(const std::string& text) const { return out.find(text) != std::string::npos; }
};

using Arguments = std::vector<std::string>;

/// A vdb-patina that runs. stderr may be a terminal.
class RunningProgram {
  public:
    RunningProgram(const Arguments& arguments, const std::filesystem::path& folder, bool errorIsTerminal = false,
                   const std::string& input = {});
    ~RunningProgram();
    RunningProgram(const RunningProgram&) = delete;
    RunningProgram& operator=(const RunningProgram&) = delete;

    /// Waits until stderr holds the text. \return false where it ended before, or a minute went by
    bool waitFor(const std::string& text);
    void signal(int number) const;
    /// Waits until the program no longer catches the signal: its handler has run. \return false where it ended before
    bool waitUntilNotCaught(int number) const;
    Outcome finish();

  private:
    bool poll(); ///< \return whether it still runs
    void readTerminal();

    TemporaryFolder logs_;
    int pid_ = -1;
    int status_ = 0;
    bool running_ = true;
    int terminal_ = -1;
    std::string terminalText_;
};

/// Runs vdb-patina to its end, in a folder.
Outcome vdbPatina(const Arguments& arguments, const std::filesystem::path& folder, const std::string& input = {});

/// Several in the same folder, two at a time: loading the program's libraries takes longer than a wrong command line.
std::vector<Outcome> vdbPatinaEach(const std::vector<Arguments>& lines, const std::filesystem::path& folder);

/// Adds the options that make a run take about a second, those that are there excepted.
Arguments small(Arguments arguments);

std::string readFile(const std::filesystem::path& path);
std::set<std::string> filesIn(const std::filesystem::path& folder);
/// "44534f02824f2f9d" of "… content hash 44534f02824f2f9d".
std::string contentHashIn(const std::string& text);

} // namespace patina::test
