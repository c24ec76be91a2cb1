#include "script/statement_checker.h"

#include "base/names.h"
#include "script/vocabulary.h"

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>

namespace patina {

namespace {

/// Words that may stand behind each operator's own.
std::vector<std::string> fittingClauses(const std::string& word) {
    if (word == "coat" || word == "convert")
        return {"as"};
    if (word == "grow")
        return {"as", "everywhere"};
    if (word == "erode")
        return {"as", "by", "and"};
    if (word == "fill")
        return {"as", "above"};
    if (word == "polish")
        return {"as", "window", "of"};
    if (word == "offset")
        return {"as", "tangent-sphere", "global"};
    return {};
}

const SyntaxClause* clauseOf(const SyntaxStatement& syntax, const char* word) {
    for (const SyntaxClause& clause : syntax.clauses)
        if (clause.word == word)
            return &clause;
    return nullptr;
}

template <typename Action>
constexpr bool hasMap = !std::is_same_v<Action, NewMetal> && !std::is_same_v<Action, OpenFile> &&
                        !std::is_same_v<Action, Offset> && !std::is_same_v<Action, Render>;

/// Gives every growth pattern of a map its random key. Patterns are shared by `let`s, keys are not: each is copied.
void labelGrowth(Expression& expression, const std::string& label, int& count) {
    if (expression.growth) {
        GrowthCall growth = *expression.growth;
        ++count;
        growth.label = count == 1 ? label : fmt::format("{}/{}", label, count);
        if (growth.arrival)
            labelGrowth(*growth.arrival, label, count);
        if (growth.blocked)
            labelGrowth(*growth.blocked, label, count);
        expression.growth = std::make_shared<const GrowthCall>(std::move(growth));
    }
    for (Expression& child : expression.children)
        labelGrowth(child, label, count);
}

} // namespace

std::optional<Statement> StatementChecker::resolve(const SyntaxStatement& syntax) {
    if (context_.operators.count(syntax.word) == 0)
        findings_.error(syntax.offset, fmt::format("'{}' is not there yet in this version", syntax.word),
                        "the script needs a later version of the program");
    const bool clausesGood = clausesFit(syntax);
    Statement out;
    out.label = label(syntax); // counted even where the statement has an error: the others keep their labels
    std::optional<Statement::Action> done = action(syntax);
    if (!done || !clausesGood)
        return std::nullopt;
    out.place = findings_.source().place(syntax.offset);
    out.text = syntax.text;
    out.word = syntax.word;
    out.action = std::move(*done);
    std::visit(
        [&out](auto& one) {
            if constexpr (hasMap<std::decay_t<decltype(one)>>) {
                int count = 0;
                if (one.map)
                    labelGrowth(*one.map, out.label, count);
            }
        },
        out.action);
    return out;
}

std::optional<Statement::Action> StatementChecker::action(const SyntaxStatement& syntax) {
    if (syntax.word == "new" || syntax.word == "open")
        return begin(syntax);
    if (syntax.word == "coat")
        return coat(syntax);
    if (syntax.word == "erode")
        return erode(syntax);
    if (syntax.word == "grow")
        return grow(syntax);
    if (syntax.word == "convert")
        return convert(syntax);
    if (syntax.word == "fill")
        return fill(syntax);
    if (syntax.word == "polish")
        return polish(syntax);
    if (syntax.word == "offset")
        return offset(syntax);
    return render(syntax);
}

bool StatementChecker::material(const SyntaxWord& word, Expected expected) {
    const auto found = std::find_if(context_.materials.begin(), context_.materials.end(),
                                    [&](const CheckContext::Material& one) { return one.name == word.text; });
    const auto names = [&](bool metals) {
        std::vector<std::string> all;
        for (const CheckContext::Material& one : context_.materials)
            if (expected == Expected::any || one.isMetal == metals)
                all.push_back(one.name);
        return all;
    };
    if (found == context_.materials.end()) {
        std::string remedy = didYouMean(word.text, names(expected == Expected::metal));
        if (remedy.empty())
            remedy = "'vdb-patina materials' lists the materials";
        findings_.error(word.offset,
                        fmt::format("unknown {} '{}'", expected == Expected::metal ? "metal" : "material", word.text),
                        remedy);
        return false;
    }
    if (expected == Expected::metal && !found->isMetal) {
        findings_.error(word.offset, fmt::format("'{}' is a layer's material, a metal is needed here", word.text),
                        fmt::format("the metals are {}", vocabulary::listed(names(true))));
        return false;
    }
    if (expected == Expected::layer && found->isMetal) {
        findings_.error(word.offset, fmt::format("'{}' is a metal, a layer's material is needed here", word.text),
                        "a metal begins the script: new " + word.text);
        return false;
    }
    return true;
}

bool StatementChecker::mapInto(const SyntaxStatement& syntax, std::optional<Expression>& map) {
    if (!syntax.map)
        return true;
    map = expressions_.map(*syntax.map);
    return map.has_value();
}

bool StatementChecker::clausesFit(const SyntaxStatement& syntax) {
    const std::vector<std::string> fitting = fittingClauses(syntax.word);
    std::set<std::string> seen;
    bool good = true;
    const auto error = [&](const SyntaxClause& clause, std::string message, std::string remedy = {}) {
        findings_.error(clause.offset, std::move(message), std::move(remedy));
        good = false;
    };
    for (const SyntaxClause& clause : syntax.clauses) {
        if (!vocabulary::contains(fitting, clause.word))
            error(clause, fmt::format("'{}' does not belong to '{}'", clause.word, syntax.word),
                  fitting.empty() ? std::string() : fmt::format("it takes {}", vocabulary::listed(fitting, "'")));
        else if (!seen.insert(clause.word).second)
            error(clause, fmt::format("'{}' stands here twice", clause.word));
        else if (clause.word != "as" && context_.clauses.count(clause.word) == 0)
            error(clause, fmt::format("'{} … {}' is not there yet in this version", syntax.word, clause.word),
                  "the script needs a later version of the program");
        else if (syntax.word == "polish" && clause.word != "as" && !syntax.area)
            error(clause, fmt::format("'{}' belongs to 'polish area'", clause.word), "polish area 0.3 …");
    }
    return good;
}

std::string StatementChecker::label(const SyntaxStatement& syntax) {
    std::string label = syntax.word == "coat" ? std::string() : syntax.word;
    if (syntax.word == "coat" || syntax.word == "fill" || syntax.word == "grow" || syntax.word == "offset" ||
        syntax.word == "convert") {
        for (const SyntaxWord& name : syntax.names)
            label += (label.empty() ? "" : " ") + name.text;
    }
    const int before = used_[label]++;
    if (const SyntaxClause* as = clauseOf(syntax, "as"))
        return as->names.at(0).text;
    return before == 0 ? label : fmt::format("{}#{}", label, before + 1);
}

void StatementChecker::warnWhereAbsent(const SyntaxWord& material) {
    if (presentKnown_ && present_.count(material.text) == 0)
        findings_.warning(material.offset,
                          fmt::format("there is no layer of '{}' yet: nothing happens", material.text));
}

std::optional<Statement::Action> StatementChecker::begin(const SyntaxStatement& syntax) {
    const SyntaxWord& name = syntax.names.at(0);
    if (syntax.word == "new") {
        if (!material(name, Expected::metal))
            return std::nullopt;
        return NewMetal{name.text};
    }
    presentKnown_ = false;
    const std::optional<std::string> file = expressions_.file(name.text, name.offset, "the volume");
    if (!file)
        return std::nullopt;
    return OpenFile{*file};
}

std::optional<Statement::Action> StatementChecker::coat(const SyntaxStatement& syntax) {
    Coat out;
    out.material = syntax.names.at(0).text;
    present_.insert(out.material);
    const bool known = material(syntax.names[0], Expected::layer);
    const auto thickness = expressions_.lengthNotNegative(syntax.values.at(0), "the thickness");
    if (!mapInto(syntax, out.map) || !known || !thickness)
        return std::nullopt;
    out.thicknessUm = *thickness;
    return out;
}

std::optional<Statement::Action> StatementChecker::erode(const SyntaxStatement& syntax) {
    Erode out;
    const auto thickness = expressions_.lengthNotNegative(syntax.values.at(0), "the thickness");
    if (!mapInto(syntax, out.map) || !thickness)
        return std::nullopt;
    out.thicknessUm = *thickness;
    out.byHardness = clauseOf(syntax, "by") != nullptr;
    out.andMetal = clauseOf(syntax, "and") != nullptr;
    return out;
}

std::optional<Statement::Action> StatementChecker::grow(const SyntaxStatement& syntax) {
    Grow out;
    out.material = syntax.names.at(0).text;
    const bool known = material(syntax.names[0], Expected::layer);
    out.everywhere = clauseOf(syntax, "everywhere") != nullptr;
    if (out.everywhere)
        present_.insert(out.material);
    else if (known)
        warnWhereAbsent(syntax.names[0]);
    const auto thickness = expressions_.lengthNotNegative(syntax.values.at(0), "the thickness");
    if (!mapInto(syntax, out.map) || !known || !thickness)
        return std::nullopt;
    out.thicknessUm = *thickness;
    return out;
}

std::optional<Statement::Action> StatementChecker::convert(const SyntaxStatement& syntax) {
    Convert out;
    out.from = syntax.names.at(0).text;
    out.to = syntax.names.at(1).text;
    bool known = material(syntax.names[0], Expected::layer);
    if (known)
        warnWhereAbsent(syntax.names[0]);
    known = material(syntax.names[1], Expected::layer) && known;
    present_.insert(out.to);
    if (out.from == out.to)
        findings_.warning(syntax.names[1].offset, fmt::format("'{}' is converted to itself", out.to));
    const auto fraction = expressions_.fraction(syntax.values.at(0), "the fraction");
    if (!mapInto(syntax, out.map) || !known || !fraction)
        return std::nullopt;
    out.fraction = *fraction;
    return out;
}

std::optional<Statement::Action> StatementChecker::fill(const SyntaxStatement& syntax) {
    Fill out;
    out.material = syntax.names.at(0).text;
    present_.insert(out.material);
    bool good = material(syntax.names[0], Expected::layer);
    const auto height = expressions_.lengthNotNegative(syntax.values.at(0), "the height");
    good = mapInto(syntax, out.map) && good;
    if (const SyntaxClause* above = clauseOf(syntax, "above")) {
        out.aboveSmoothRadiusUm = expressions_.lengthPositive(above->values.at(0), "the radius");
        good = good && out.aboveSmoothRadiusUm;
    }
    if (!good || !height)
        return std::nullopt;
    out.heightUm = *height;
    return out;
}

std::optional<Statement::Action> StatementChecker::polish(const SyntaxStatement& syntax) {
    Polish out;
    if (syntax.area)
        out.area = expressions_.fraction(syntax.values.at(0), "the fraction of plateau");
    else
        out.heightUm = expressions_.lengthNotNegative(syntax.values.at(0), "the height");
    bool good = mapInto(syntax, out.map) && (out.area || out.heightUm);
    if (const SyntaxClause* window = clauseOf(syntax, "window")) {
        out.windowUm = expressions_.lengthPositive(window->values.at(0), "the window");
        good = good && out.windowUm;
    }
    if (const SyntaxClause* of = clauseOf(syntax, "of")) {
        out.ofMaterial = of->names.at(0).text;
        good = material(of->names[0], Expected::any) && good;
    }
    if (!good)
        return std::nullopt;
    return out;
}

std::optional<Statement::Action> StatementChecker::offset(const SyntaxStatement& syntax) {
    Offset out;
    out.material = syntax.names.at(0).text;
    present_.insert(out.material);
    bool good = material(syntax.names[0], Expected::layer);
    const auto radius = expressions_.lengthPositive(syntax.values.at(0), "the radius");
    if (const SyntaxClause* sphere = clauseOf(syntax, "tangent-sphere")) {
        out.tangentSphereThicknessUm = expressions_.lengthNotNegative(sphere->values.at(0), "the thickness");
        good = good && out.tangentSphereThicknessUm;
    }
    out.global = clauseOf(syntax, "global") != nullptr;
    if (!good || !radius)
        return std::nullopt;
    out.radiusUm = *radius;
    return out;
}

std::optional<Statement::Action> StatementChecker::render(const SyntaxStatement& syntax) {
    const SyntaxWord& target = syntax.names.at(0);
    if (context_.renderTargets.count(target.text) == 0) {
        const std::vector<std::string> known(context_.renderTargets.begin(), context_.renderTargets.end());
        std::string remedy = didYouMean(target.text, known);
        if (remedy.empty())
            remedy = fmt::format("what can be rendered: {}", vocabulary::listed(known));
        findings_.error(target.offset, fmt::format("unknown result '{}'", target.text), remedy);
        return std::nullopt;
    }
    return Render{target.text};
}

} // namespace patina
