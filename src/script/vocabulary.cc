#include "script/vocabulary.h"

#include "base/units.h"

#include <algorithm>

namespace patina::vocabulary {

const std::vector<std::string>& statementWords() {
    static const std::vector<std::string> words = {"new",     "open",  "coat",   "erode",  "grow",
                                                   "convert", "fill",  "polish", "offset", "render",
                                                   "let",     "param", "curve",  "seed",   "repeat"};
    return words;
}

const std::vector<std::string>& clauseWords() {
    static const std::vector<std::string> words = {"as", "by",      "and",    "above",     "window",
                                                   "of", "tangent", "global", "everywhere"};
    return words;
}

std::vector<std::string> operatorWords() {
    const auto& words = statementWords();
    return {words.begin(), std::find(words.begin(), words.end(), "let")};
}

std::vector<std::string> optionalClauses() {
    return {"by", "and", "above", "window", "of", "tangent-sphere", "global", "everywhere"};
}

const std::vector<std::string>& fieldNames() {
    static const std::vector<std::string> names = {"exposure", "wetness", "slope", "elevation"};
    return names;
}

namespace {

const std::vector<Signature>& signatures() {
    static const std::vector<Signature> all = {
        {"texture", "texture(\"file.png\", channel) or texture(BD.linear_1.20)", 1, 2},
        {"vertices", "vertices(NAME)", 1, 1},
        {"noise", "noise(size)", 1, 1},
        {"turbulence", "turbulence(size, octaves)", 2, 2},
        {"accessibility", "accessibility(radius)", 1, 1},
        {"facing", "facing(x, y, z)", 3, 3},
        {"min", "min(a, b)", 2, -1},
        {"max", "max(a, b)", 2, -1},
        {"clamp", "clamp(value, lowest, highest)", 3, 3},
        {"mix", "mix(a, b, share_of_b)", 3, 3},
        {"pow", "pow(base, exponent)", 2, 2},
        {"smoothstep", "smoothstep(from, to, value)", 3, 3},
        {"iso9224", "iso9224(METAL, CATEGORY, years) or iso9224(METAL, CATEGORY, years, position)", 3, 4},
        {"expansion", "expansion(MATERIAL)", 1, 1},
    };
    return all;
}

} // namespace

const std::vector<std::string>& functionNames() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const Signature& entry : signatures())
            all.push_back(entry.name);
        return all;
    }();
    return names;
}

const Signature* signature(std::string_view function) {
    for (const Signature& entry : signatures())
        if (entry.name == function)
            return &entry;
    return nullptr;
}

const std::vector<std::string>& growthModels() {
    static const std::vector<std::string> names = {"ST", "RD", "RDR", "BD", "DPD", "DPD_BS"};
    return names;
}

const std::vector<std::string>& growthRates() {
    static const std::vector<std::string> names = {"linear", "parabolic", "cubic", "logarithmic"};
    return names;
}

std::vector<std::string> growthArguments(std::string_view model) {
    if (!contains(growthModels(), model))
        return {};
    std::vector<std::string> names = {"rate", "step", "total", "since", "cell"};
    const auto add = [&names](std::initializer_list<std::string> more) { names.insert(names.end(), more); };
    if (model == "ST")
        add({"points"});
    if (model == "RD" || model == "RDR" || model == "BD")
        add({"arrival", "from"});
    if (model == "RDR")
        add({"reach"});
    if (model == "DPD" || model == "DPD_BS")
        add({"blocked"});
    if (model == "DPD")
        add({"patch", "seeding"});
    return names;
}

bool isReserved(std::string_view word) {
    return contains(statementWords(), word) || contains(clauseWords(), word) || word == "step" || word == "full" ||
           word == "to" || word == "area" || micrometresPerUnit(word).has_value();
}

bool contains(const std::vector<std::string>& words, std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

std::string listed(const std::vector<std::string>& words, const std::string& quote) {
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (i > 0)
            text += i + 1 == words.size() ? " and " : ", ";
        text += quote + words[i] + quote;
    }
    return text;
}

} // namespace patina::vocabulary
