#pragma once
// What can go wrong, where, and what to do about it. Library code throws these and never prints or exits;
// tools/ catches them and turns them into text and an exit code.

#include <stdexcept>
#include <string>
#include <vector>

namespace patina {

/// Exit codes of the program: promises to scripts and build systems.
enum class ExitCode {
    done = 0,
    failed = 1,      ///< failed while running: disk full, unreadable file
    commandLine = 2, ///< wrong option or argument
    script = 3,      ///< error in a script or a material file
    model = 4,       ///< the model cannot be used
    budget = 5,      ///< over the budget, nothing was started
    interrupted = 130,
};

/// A place in a text file. Lines and columns count from 1; 0 means "the file as a whole".
struct SourcePlace {
    std::string file;
    int line = 0;
    int column = 0;

    /// "file:line:column", shortened to what is known.
    std::string text() const;
};

/// One finding about a text a person wrote.
struct Diagnostic {
    enum class Severity { error, warning };
    Severity severity = Severity::error;
    SourcePlace place;
    std::string message;    ///< "unknown material 'cuprit'"
    std::string remedy;     ///< "did you mean 'cuprite_2'?"; may be empty
    std::string sourceLine; ///< the line of the text, for the caret; may be empty

    /// `file:3:14: error: message`, the line, a caret under the column, the remedy. Ends without a newline.
    std::string text() const;
};

/// An error with its place (a file, face, grid, option; may be empty) and its remedy (may be empty).
class Error : public std::runtime_error {
  public:
    Error(ExitCode code, std::string place, std::string message, std::string remedy = {});

    ExitCode code() const { return code_; }
    const std::string& place() const { return place_; }
    const std::string& message() const { return message_; }
    const std::string& remedy() const { return remedy_; }

  private:
    ExitCode code_;
    std::string place_;
    std::string message_;
    std::string remedy_;
};

/// The model cannot be used (exit 4).
class ModelError : public Error {
  public:
    ModelError(std::string place, std::string message, std::string remedy = {})
        : Error(ExitCode::model, std::move(place), std::move(message), std::move(remedy)) {}
};

/// A file could not be read or written, or another failure while running (exit 1).
class RunError : public Error {
  public:
    RunError(std::string place, std::string message, std::string remedy = {})
        : Error(ExitCode::failed, std::move(place), std::move(message), std::move(remedy)) {}
};

/// All the errors (and warnings) of one script or material file in one go (exit 3).
class ScriptError : public Error {
  public:
    explicit ScriptError(std::vector<Diagnostic> diagnostics);
    const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

  private:
    std::vector<Diagnostic> diagnostics_;
};

/// The user pressed Ctrl-C; thrown by Progress::checkpoint().
class Interrupted : public Error {
  public:
    Interrupted() : Error(ExitCode::interrupted, {}, "interrupted") {}
};

} // namespace patina
