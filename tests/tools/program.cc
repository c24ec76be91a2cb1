#include "program.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>

namespace patina::test {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

namespace {

constexpr auto patience = std::chrono::seconds(60);

void pauseShortly() {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

std::vector<std::string> environment() {
    std::vector<std::string> variables;
    for (char** variable = environ; *variable; ++variable)
        if (std::string(*variable).rfind("VDB_PATINA_DATA=", 0) != 0)
            variables.emplace_back(*variable);
    // A test that needs data of its own says where they are in PATINA_TEST_DATA.
    const char* own = std::getenv("PATINA_TEST_DATA");
    variables.emplace_back(std::string("VDB_PATINA_DATA=") + (own ? own : PATINA_SOURCE_DIR "/data"));
    return variables;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> list;
    for (std::string& text : texts)
        list.push_back(text.data());
    list.push_back(nullptr);
    return list;
}

} // namespace

TemporaryFolder::TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "vdb-patina-test-XXXXXX").string();
    if (!::mkdtemp(name.data()))
        throw std::runtime_error("cannot make a temporary folder");
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

std::string TemporaryFolder::file(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return at(name);
}

RunningProgram::RunningProgram(const Arguments& arguments, const fs::path& folder, bool errorIsTerminal,
                               const std::string& input) {
    std::vector<std::string> words{PATINA_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<std::string> variables = environment();
    const std::string in = logs_.file("in", input), out = logs_.file("out", ""), err = logs_.file("err", "");
    std::string errorTo = err;
    if (errorIsTerminal) {
        terminal_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
        if (terminal_ < 0 || ::grantpt(terminal_) != 0 || ::unlockpt(terminal_) != 0)
            throw std::runtime_error("cannot open a terminal");
        errorTo = ::ptsname(terminal_);
    }
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, in.c_str(), O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, errorTo.c_str(), O_WRONLY | O_NOCTTY, 0);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    const int failure =
        ::posix_spawn(&pid_, PATINA_PROGRAM, &actions, nullptr, pointers(words).data(), pointers(variables).data());
    posix_spawn_file_actions_destroy(&actions);
    if (failure != 0)
        throw std::runtime_error("cannot start " PATINA_PROGRAM);
}

RunningProgram::~RunningProgram() {
    if (poll()) {
        ::kill(pid_, SIGKILL);
        ::waitpid(pid_, &status_, 0);
    }
    if (terminal_ >= 0)
        ::close(terminal_);
}

void RunningProgram::readTerminal() {
    char buffer[4096];
    for (ssize_t count = 0; terminal_ >= 0 && (count = ::read(terminal_, buffer, sizeof buffer)) > 0;)
        terminalText_.append(buffer, static_cast<std::size_t>(count));
}

bool RunningProgram::poll() {
    readTerminal();
    if (running_ && ::waitpid(pid_, &status_, WNOHANG) == pid_)
        running_ = false;
    return running_;
}

bool RunningProgram::waitFor(const std::string& text) {
    for (const auto start = Clock::now(); Clock::now() - start < patience; pauseShortly()) {
        const bool running = poll();
        if (readFile(logs_.path() / "err").find(text) != std::string::npos)
            return running;
        if (!running)
            return false;
    }
    return false;
}

void RunningProgram::signal(int number) const {
    ::kill(pid_, number);
}

bool RunningProgram::waitUntilNotCaught(int number) const {
    for (const auto start = Clock::now(); Clock::now() - start < patience;) {
        std::istringstream status(readFile("/proc/" + std::to_string(pid_) + "/status"));
        bool found = false;
        for (std::string line; std::getline(status, line);)
            if (line.rfind("SigCgt:", 0) == 0) {
                found = true;
                if ((std::stoull(line.substr(7), nullptr, 16) >> (number - 1) & 1) == 0)
                    return true;
            }
        if (!found)
            return false;
    }
    return false;
}

Outcome RunningProgram::finish() {
    const auto start = Clock::now();
    while (poll()) {
        if (Clock::now() - start > patience) {
            ADD_FAILURE() << "the program did not end within a minute";
            ::kill(pid_, SIGKILL);
        }
        pauseShortly();
    }
    readTerminal();
    Outcome outcome;
    if (WIFEXITED(status_))
        outcome.exitCode = WEXITSTATUS(status_);
    if (WIFSIGNALED(status_))
        outcome.signal = WTERMSIG(status_);
    outcome.out = readFile(logs_.path() / "out");
    outcome.err = terminal_ >= 0 ? terminalText_ : readFile(logs_.path() / "err");
    return outcome;
}

Outcome vdbPatina(const Arguments& arguments, const fs::path& folder, const std::string& input) {
    return RunningProgram(arguments, folder, false, input).finish();
}

std::vector<Outcome> vdbPatinaEach(const std::vector<Arguments>& lines, const fs::path& folder) {
    std::vector<Outcome> outcomes(lines.size());
    std::unique_ptr<RunningProgram> before;
    for (std::size_t i = 0; i <= lines.size(); ++i) {
        auto next = i < lines.size() ? std::make_unique<RunningProgram>(lines[i], folder) : nullptr;
        if (before)
            outcomes[i - 1] = before->finish();
        before = std::move(next);
    }
    return outcomes;
}

Arguments small(Arguments arguments) {
    const std::pair<const char*, const char*> options[] = {
        {"--voxels", "32"}, {"--resolution", "64"}, {"--picture", "48"}, {"--samples", "1"}};
    for (const auto& [name, value] : options)
        if (std::find(arguments.begin(), arguments.end(), name) == arguments.end())
            arguments.insert(arguments.end(), {name, value});
    return arguments;
}

std::string readFile(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

std::set<std::string> filesIn(const fs::path& folder) {
    std::set<std::string> names;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored))
        names.insert(entry.path().filename().string());
    return names;
}

std::string contentHashIn(const std::string& text) {
    const std::string before = "content hash ";
    const std::size_t at = text.find(before);
    return at == std::string::npos ? std::string() : text.substr(at + before.size(), 16);
}

} // namespace patina::test
