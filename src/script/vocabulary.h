#pragma once
// The words of the language, in one place.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace patina::vocabulary {

/// Words that begin a statement; reserved as names.
const std::vector<std::string>& statementWords();
/// Words that begin a clause behind a statement ("as", "by", …); reserved as names.
const std::vector<std::string>& clauseWords();
/// Names that stand for a field by themselves.
const std::vector<std::string>& fieldNames();
/// Statements that do something to the object or with it ("new" … "render").
std::vector<std::string> operatorWords();
/// Clauses that a build may or may not implement ("by", "and", "above", "window", "of", "tangent-sphere", "global",
/// "everywhere").
std::vector<std::string> optionalClauses();
const std::vector<std::string>& functionNames();
const std::vector<std::string>& growthModels();
const std::vector<std::string>& growthRates();
/// Named arguments that a growth model takes, "rate", "step" and "total" included. Empty for an unknown model.
std::vector<std::string> growthArguments(std::string_view model);

/// Statement, clause and unit words, "step", "full", "to", "area": none of them can be a name.
bool isReserved(std::string_view word);
bool contains(const std::vector<std::string>& words, std::string_view word);
/// "a, b and c"; `quote` stands on both sides of each.
std::string listed(const std::vector<std::string>& words, const std::string& quote = {});

/// How a function may be called, for messages: "noise(size)".
struct Signature {
    std::string name;
    std::string usage;
    int fewest = 0;
    int most = 0; ///< -1: any number
};
/// Null for an unknown function. (texture has two forms; its arguments are checked by hand.)
const Signature* signature(std::string_view function);

} // namespace patina::vocabulary
