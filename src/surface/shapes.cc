#include "surface/shapes.h"

#include "base/errors.h"
#include "base/names.h"
#include "surface/shape_makers.h"

#include <array>
#include <utility>

namespace patina {

namespace {

using Maker = Mesh (*)();
constexpr std::array<std::pair<const char*, Maker>, 6> makers = {{
    {"plate", makePlate},
    {"strip", makeStrip},
    {"sphere", makeSphere},
    {"groove", makeGroove},
    {"tower", makeTower},
    {"statuette", makeStatuette},
}};

} // namespace

std::vector<std::string> shapeNames() {
    std::vector<std::string> names;
    for (const auto& [name, make] : makers)
        names.emplace_back(name);
    return names;
}

Mesh makeShape(const std::string& name) {
    for (const auto& [known, make] : makers)
        if (name == known)
            return make();
    std::string remedy = didYouMean(name, shapeNames());
    if (remedy.empty()) {
        remedy = "one of";
        for (const std::string& known : shapeNames())
            remedy += " " + known;
    }
    throw Error(ExitCode::commandLine, {}, "unknown shape '" + name + "'", remedy);
}

} // namespace patina
