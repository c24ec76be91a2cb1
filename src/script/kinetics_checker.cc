// iso9224(METAL, CATEGORY, years, position) and expansion(MATERIAL): constants out of the data files.

#include "base/names.h"
#include "script/expression_checker.h"
#include "script/vocabulary.h"

#include <fmt/format.h>

namespace patina {

namespace {

template <typename Value>
std::vector<std::string> keysOf(const std::map<std::string, Value>& map) {
    std::vector<std::string> names;
    for (const auto& entry : map)
        names.push_back(entry.first);
    return names;
}

} // namespace

std::optional<std::string> KineticsChecker::word(const SyntaxExpression& syntax, const std::vector<std::string>& known,
                                                 const std::string& what) {
    const bool isWord =
        syntax.kind == SyntaxExpression::Kind::name || syntax.kind == SyntaxExpression::Kind::string;
    if (isWord && vocabulary::contains(known, syntax.text))
        return syntax.text;
    std::string remedy = isWord ? didYouMean(syntax.text, known) : "";
    if (remedy.empty())
        remedy = fmt::format("there are {}", vocabulary::listed(known));
    expressions_.findings_.error(
        syntax.offset, isWord ? fmt::format("{} '{}' is not known", what, syntax.text) : what + " is a name", remedy);
    return std::nullopt;
}

std::optional<Expression> KineticsChecker::iso9224(const SyntaxExpression& syntax) {
    const Kinetics& kinetics = expressions_.context_.kinetics;
    const auto metal = word(syntax.children[0], keysOf(kinetics.metals), "the corrosion of");
    const auto years = expressions_.plainNumber(syntax.children[2], "the time in years");
    std::optional<double> position = 0.5;
    if (syntax.children.size() > 3)
        position = expressions_.fraction(syntax.children[3], "the place within the category's range");
    if (!metal)
        return std::nullopt;
    const MetalKinetics& course = kinetics.metals.at(*metal);
    const auto category = word(syntax.children[1], keysOf(course.firstYearUm), "the corrosivity category");
    if (!category || !years || !position)
        return std::nullopt;
    Expression out = expressions_.node(Expression::Kind::number, syntax);
    out.text.clear();
    out.number = metalLossUm(course.exponent, course.firstYearUm.at(*category), *position, *years);
    out.isLength = true;
    return out;
}

std::optional<Expression> KineticsChecker::expansion(const SyntaxExpression& syntax) {
    const auto& known = expressions_.context_.kinetics.expansion;
    const auto material = word(syntax.children[0], keysOf(known), "the expansion of");
    if (!material)
        return std::nullopt;
    Expression out = expressions_.node(Expression::Kind::number, syntax);
    out.text.clear();
    out.number = known.at(*material);
    return out;
}

} // namespace patina
