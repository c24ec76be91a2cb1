#include "base/errors.h"

#include <fmt/format.h>

namespace patina {

namespace {

std::string describe(const std::string& place, const std::string& message, const std::string& remedy) {
    std::string text = place.empty() ? message : fmt::format("{}: {}", place, message);
    if (!remedy.empty())
        text += fmt::format(" ({})", remedy);
    return text;
}

std::string describe(const std::vector<Diagnostic>& diagnostics) {
    std::string text;
    for (const Diagnostic& diagnostic : diagnostics) {
        if (!text.empty())
            text += '\n';
        text += diagnostic.text();
    }
    return text;
}

} // namespace

std::string SourcePlace::text() const {
    if (line <= 0)
        return file;
    if (column <= 0)
        return fmt::format("{}:{}", file, line);
    return fmt::format("{}:{}:{}", file, line, column);
}

std::string Diagnostic::text() const {
    std::string out =
        fmt::format("{}: {}: {}", place.text(), severity == Severity::error ? "error" : "warning", message);
    if (!sourceLine.empty()) {
        out += fmt::format("\n    {}", sourceLine);
        if (place.column > 0) {
            // Tabs are kept so that the caret stands under its character whatever a tab's width is.
            std::string indent;
            for (int i = 0; i + 1 < place.column && i < static_cast<int>(sourceLine.size()); ++i)
                indent += sourceLine[i] == '\t' ? '\t' : ' ';
            out += fmt::format("\n    {}^", indent);
        }
    }
    if (!remedy.empty())
        out += fmt::format("\n    {}", remedy);
    return out;
}

Error::Error(ExitCode code, std::string place, std::string message, std::string remedy)
    : std::runtime_error(describe(place, message, remedy)), code_(code), place_(std::move(place)),
      message_(std::move(message)), remedy_(std::move(remedy)) {}

ScriptError::ScriptError(std::vector<Diagnostic> diagnostics)
    : Error(ExitCode::script, {}, describe(diagnostics)), diagnostics_(std::move(diagnostics)) {}

} // namespace patina
