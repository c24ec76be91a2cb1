#include "base/names.h"
#include "script/expression_checker.h"
#include "script/vocabulary.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>

namespace patina {

using SyntaxKind = SyntaxExpression::Kind;

namespace {

constexpr double largestTotal = 1e6;

} // namespace

bool GrowthChecker::looksLikeGrowth(const SyntaxExpression& syntax) {
    if (syntax.kind == SyntaxKind::growthShort)
        return true;
    if (syntax.kind != SyntaxKind::call || vocabulary::signature(syntax.text))
        return false;
    return true;
}

bool GrowthChecker::rate(const std::string& word, std::size_t offset, GrowthCall& out) {
    out.rate = word;
    if (vocabulary::contains(vocabulary::growthRates(), word))
        return true;
    std::string remedy = didYouMean(word, vocabulary::growthRates());
    if (remedy.empty())
        remedy = fmt::format("the rates are {}", vocabulary::listed(vocabulary::growthRates()));
    expressions_.findings_.error(offset, fmt::format("unknown growth rate '{}'", word), remedy);
    return false;
}

bool GrowthChecker::moment(const GrowthCall& growth, std::size_t stepOffset, std::size_t totalOffset) {
    Findings& findings = expressions_.findings_;
    if (growth.total < 1 || growth.total > largestTotal) {
        findings.error(totalOffset,
                       fmt::format("the total must be 1 to {:.0f}, this is {}", largestTotal, growth.total));
        return false;
    }
    if (growth.step < 1) {
        findings.error(stepOffset, fmt::format("the step must be at least 1, this is {}", growth.step));
        return false;
    }
    if (growth.step > growth.total) {
        findings.error(stepOffset, fmt::format("step {} is beyond the total of {}", growth.step, growth.total),
                       "a pattern is written NAME.rate_step.total, and its step goes from 1 to the total");
        return false;
    }
    return true;
}

std::optional<GrowthCall> GrowthChecker::resolve(const SyntaxExpression& syntax) {
    Findings& findings = expressions_.findings_;
    GrowthCall out;
    out.place = findings.source().place(syntax.offset);
    out.model = syntax.text;
    bool good = true;
    if (!vocabulary::contains(vocabulary::growthModels(), syntax.text)) {
        std::string remedy = didYouMean(syntax.text, vocabulary::growthModels());
        if (remedy.empty())
            remedy = fmt::format("the models are {}", vocabulary::listed(vocabulary::growthModels()));
        findings.error(syntax.offset, fmt::format("unknown growth model '{}'", syntax.text), remedy);
        good = false;
    } else if (expressions_.context_.models.count(syntax.text) == 0) {
        findings.error(syntax.offset,
                       fmt::format("the growth model '{}' is not there yet in this version", syntax.text));
        good = false;
    }
    if (syntax.kind == SyntaxKind::growthShort) {
        out.step = syntax.step;
        out.total = syntax.total;
        good = rate(syntax.rate.text, syntax.rate.offset, out) && good;
        good = moment(out, syntax.stepOffset, syntax.totalOffset) && good;
        return good ? std::optional<GrowthCall>(std::move(out)) : std::nullopt;
    }

    std::map<std::string, std::size_t> given;
    for (std::size_t i = 0; i < syntax.children.size(); ++i) {
        const SyntaxWord& name = syntax.argumentNames[i];
        if (name.text.empty()) {
            findings.error(syntax.children[i].offset, "the arguments of a growth model are named",
                           fmt::format("{}(rate=linear, step=1, total=20)", syntax.text));
            good = false;
        } else if (!given.emplace(name.text, i).second) {
            findings.error(name.offset, fmt::format("the argument '{}' is given twice", name.text));
            good = false;
        } else {
            good = argument(syntax, i, out) && good;
        }
    }
    for (const char* needed : {"rate", "step", "total"}) {
        if (given.count(needed) == 0) {
            findings.error(syntax.offset,
                           fmt::format("the growth model '{}' needs the argument '{}'", syntax.text, needed),
                           fmt::format("{}(rate=linear, step=1, total=20)", syntax.text));
            good = false;
        }
    }
    if (good)
        good = moment(out, syntax.children[given["step"]].offset, syntax.children[given["total"]].offset);
    if (good && out.since >= out.step) {
        findings.error(syntax.children[given["since"]].offset,
                       fmt::format("step {} does not come after step {}", out.step, out.since),
                       "since=N is an earlier step of the same history");
        good = false;
    }
    return good ? std::optional<GrowthCall>(std::move(out)) : std::nullopt;
}

bool GrowthChecker::argument(const SyntaxExpression& syntax, std::size_t index, GrowthCall& out) {
    Findings& findings = expressions_.findings_;
    const SyntaxWord& name = syntax.argumentNames[index];
    const SyntaxExpression& value = syntax.children[index];
    static const std::vector<std::string> known = {"rate",  "step",    "total", "cell",    "arrival", "from",
                                                   "reach", "blocked", "patch", "seeding", "points", "since"};
    if (!vocabulary::contains(known, name.text)) {
        std::string remedy = didYouMean(name.text, known);
        if (remedy.empty())
            remedy = fmt::format("the arguments are {}", vocabulary::listed(known));
        findings.error(name.offset, fmt::format("unknown argument '{}'", name.text), remedy);
        return false;
    }
    const std::vector<std::string> fitting = vocabulary::growthArguments(syntax.text);
    if (!fitting.empty() && !vocabulary::contains(fitting, name.text)) {
        findings.error(name.offset,
                       fmt::format("the growth model '{}' does not use the argument '{}'", syntax.text, name.text),
                       fmt::format("it uses {}", vocabulary::listed(fitting)));
        return false;
    }
    if (expressions_.context_.growthArguments.count(name.text) == 0) {
        findings.error(name.offset, fmt::format("the argument '{}' is not there yet in this version", name.text));
        return false;
    }
    const auto assign = [](auto& target, auto found) {
        if (found)
            target = static_cast<typename std::decay_t<decltype(target)>::value_type>(*found);
        return found.has_value();
    };
    if (name.text == "rate") {
        if (value.kind != SyntaxKind::name) {
            findings.error(value.offset, "the rate is a word",
                           fmt::format("the rates are {}", vocabulary::listed(vocabulary::growthRates())));
            return false;
        }
        return rate(value.text, value.offset, out);
    }
    if (name.text == "step" || name.text == "total") {
        const auto number = expressions_.wholeNumber(value, "the " + name.text, 1, largestTotal);
        if (number)
            (name.text == "step" ? out.step : out.total) = static_cast<int>(*number);
        return number.has_value();
    }
    if (name.text == "since") {
        const auto number = expressions_.wholeNumber(value, "the step since when", 0, largestTotal);
        if (number)
            out.since = static_cast<int>(*number);
        return number.has_value();
    }
    if (name.text == "cell")
        return assign(out.cellUm, expressions_.lengthPositive(value, "the size of a cell"));
    if (name.text == "reach")
        return assign(out.reachUm, expressions_.lengthNotNegative(value, "the reach"));
    if (name.text == "seeding")
        return assign(out.seeding, expressions_.fraction(value, "the chance of seeding"));
    if (name.text == "patch")
        return assign(out.patchCells, expressions_.wholeNumber(value, "the side of a patch in cells", 1, 10000));
    if (name.text == "points")
        return assign(out.points, expressions_.wholeNumber(value, "the number of points", 1, 1e7));
    if (name.text == "from")
        return direction(value, out);

    std::optional<Expression> map = expressions_.resolveNode(value);
    if (!map)
        return false;
    if (map->isLength) {
        findings.error(value.offset,
                       fmt::format("'{}' is a number or a map without a unit, this is a length", name.text));
        return false;
    }
    if (map->kind == Expression::Kind::number && (map->number < 0.0 || map->number > 1.0)) {
        findings.error(value.offset, fmt::format("'{}' must be between 0 and 1, this is {:g}", name.text, map->number));
        return false;
    }
    (name.text == "arrival" ? out.arrival : out.blocked) = std::move(*map);
    return true;
}

bool GrowthChecker::direction(const SyntaxExpression& syntax, GrowthCall& out) {
    Findings& findings = expressions_.findings_;
    if (syntax.kind != SyntaxKind::tuple || syntax.children.size() != 3) {
        findings.error(syntax.offset, "a direction has three numbers", "from=(0, 0, 1) is from above");
        return false;
    }
    std::array<double, 3> components{};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto number = expressions_.plainNumber(syntax.children[i], "a component of the direction");
        if (!number)
            return false;
        components[i] = *number;
    }
    const double size = std::hypot(components[0], components[1], components[2]);
    if (size == 0.0 || !std::isfinite(size)) {
        findings.error(syntax.offset, "the direction (0, 0, 0) comes from nowhere", "from=(0, 0, 1) is from above");
        return false;
    }
    for (double& component : components)
        component /= size;
    out.from = components;
    return true;
}

} // namespace patina
