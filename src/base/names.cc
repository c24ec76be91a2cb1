#include "base/names.h"

#include <fmt/format.h>

#include <algorithm>

namespace patina {

int editDistance(std::string_view a, std::string_view b) {
    const std::size_t columns = b.size() + 1;
    std::vector<int> before(columns), last(columns), current(columns);
    for (std::size_t j = 0; j < columns; ++j)
        last[j] = static_cast<int>(j);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        current[0] = static_cast<int>(i);
        for (std::size_t j = 1; j < columns; ++j) {
            const int substitution = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            current[j] = std::min({last[j] + 1, current[j - 1] + 1, substitution});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                current[j] = std::min(current[j], before[j - 2] + 1);
        }
        std::swap(before, last);
        std::swap(last, current);
    }
    return last[b.size()];
}

std::string didYouMean(std::string_view word, const std::vector<std::string>& candidates) {
    const std::string* best = nullptr;
    int bestDistance = 1 + static_cast<int>(std::max<std::size_t>(1, word.size() / 3));
    for (const std::string& candidate : candidates) {
        int distance = editDistance(word, candidate);
        // 'cuprit' is meant as 'cuprite_2' although three letters are missing at its end.
        if (word.size() >= 3 && candidate.compare(0, word.size(), word) == 0)
            distance = std::min(distance, 1);
        if (distance < bestDistance) {
            bestDistance = distance;
            best = &candidate;
        }
    }
    return best ? fmt::format("did you mean '{}'?", *best) : std::string();
}

} // namespace patina
