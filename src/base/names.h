#pragma once
// Finding the name that was meant.

#include <string>
#include <string_view>
#include <vector>

namespace patina {

/// Levenshtein distance with transpositions of neighbours counted as one edit.
int editDistance(std::string_view a, std::string_view b);

/// "did you mean 'cuprite_2'?" for the closest candidate (a prefix counts as close), or "" when none is near.
std::string didYouMean(std::string_view word, const std::vector<std::string>& candidates);

} // namespace patina
