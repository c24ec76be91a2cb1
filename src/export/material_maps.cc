#include "export/material_maps.h"

namespace patina {

std::string identifierOf(const std::string& name) {
    std::string word;
    for (const char c : name) {
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
        word += letter || (c >= '0' && c <= '9') ? c : '_';
    }
    if (word.empty() || (word[0] >= '0' && word[0] <= '9'))
        word.insert(word.begin(), '_');
    return word;
}

} // namespace patina
