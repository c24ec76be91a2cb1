#include "script/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

namespace patina {

void Findings::error(std::size_t offset, std::string message, std::string remedy) {
    if (all_.size() > 2 * mostFindings || !known_.emplace(offset, message).second)
        return;
    add(source_.diagnostic(Diagnostic::Severity::error, offset, std::move(message), std::move(remedy)));
}

void Findings::warning(std::size_t offset, std::string message, std::string remedy) {
    if (all_.size() > 2 * mostFindings || !known_.emplace(offset, message).second)
        return;
    add(source_.diagnostic(Diagnostic::Severity::warning, offset, std::move(message), std::move(remedy)));
}

void Findings::errorAt(SourcePlace place, std::string message, std::string remedy) {
    Diagnostic finding;
    finding.place = std::move(place);
    finding.message = std::move(message);
    finding.remedy = std::move(remedy);
    add(std::move(finding));
}

void Findings::add(Diagnostic finding) {
    errors_ += finding.severity == Diagnostic::Severity::error;
    all_.push_back(std::move(finding));
}

std::vector<Diagnostic> Findings::sorted() const {
    std::vector<Diagnostic> out = all_;
    std::stable_sort(out.begin(), out.end(), [](const Diagnostic& a, const Diagnostic& b) {
        return std::tie(a.place.line, a.place.column) < std::tie(b.place.line, b.place.column);
    });
    if (out.size() > mostFindings) {
        out.resize(mostFindings);
        Diagnostic more;
        more.place.file = source_.file();
        more.message = fmt::format("more than {} findings; the others are not shown", mostFindings);
        out.push_back(std::move(more));
    }
    return out;
}

} // namespace patina
