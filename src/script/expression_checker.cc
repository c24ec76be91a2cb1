#include "script/expression_checker.h"

#include "base/names.h"
#include "script/vocabulary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina {

using Kind = Expression::Kind;
using SyntaxKind = SyntaxExpression::Kind;

namespace {

/// `let`s that use each other twice double at every step; no map a person writes comes near this.
constexpr int mostResolvedNodes = 10000;

bool isConstant(const Expression& expression) {
    return expression.kind == Kind::number;
}

class Nesting {
  public:
    explicit Nesting(int& depth) : depth_(depth) { ++depth_; }
    ~Nesting() { --depth_; }
    Nesting(const Nesting&) = delete;
    Nesting& operator=(const Nesting&) = delete;

  private:
    int& depth_;
};

} // namespace

int ExpressionChecker::nodeCount(const Expression& expression) {
    int count = 1;
    for (const Expression& child : expression.children)
        count += nodeCount(child);
    return count;
}

Expression ExpressionChecker::node(Kind kind, const SyntaxExpression& syntax) const {
    Expression out;
    out.kind = kind;
    out.place = findings_.source().place(syntax.offset);
    out.text = kind == Kind::number ? std::string() : syntax.text;
    return out;
}

std::optional<Expression> ExpressionChecker::resolve(const SyntaxExpression& syntax) {
    return resolveNode(syntax);
}

std::optional<Expression> ExpressionChecker::map(const SyntaxExpression& syntax) {
    std::optional<Expression> out = resolve(syntax);
    if (!out)
        return out;
    if (out->isLength) {
        findings_.error(syntax.offset, "a map is a factor without a unit, this is a length",
                        "the thickness stands before the map, without an operator between them");
        return std::nullopt;
    }
    if (isConstant(*out) && (out->number < 0.0 || out->number > 1.0))
        findings_.warning(syntax.offset,
                          fmt::format("the factor {:g} is beyond 0 to 1 and will be clamped", out->number));
    return out;
}

std::optional<Expression> ExpressionChecker::resolveNode(const SyntaxExpression& syntax) {
    const Nesting nesting(depth_);
    if (depth_ == 1)
        nodes_ = 0; // a whole expression begins
    if (++nodes_ > mostResolvedNodes) {
        findings_.error(syntax.offset, "the expression is too large once its 'let's are put in");
        return std::nullopt;
    }
    const bool mayBeOfFull = syntax.kind == SyntaxKind::call || syntax.kind == SyntaxKind::growthShort;
    if (syntax.ofFull && !mayBeOfFull) {
        findings_.error(syntax.ofOffset, "'of full' belongs behind a growth pattern",
                        "texture(BD.linear_1.20) of full");
        return std::nullopt;
    }
    switch (syntax.kind) {
    case SyntaxKind::number: {
        Expression out = node(Kind::number, syntax);
        out.number = syntax.number;
        out.isLength = syntax.isLength;
        return out;
    }
    case SyntaxKind::string:
        findings_.error(syntax.offset, "a quoted text can only be a texture's file",
                        fmt::format("texture(\"{}\")", syntax.text.substr(0, 60)));
        return std::nullopt;
    case SyntaxKind::tuple:
        findings_.error(syntax.offset, "a list has no place here");
        return std::nullopt;
    case SyntaxKind::growthShort:
        findings_.error(syntax.offset, "a growth pattern stands inside texture( )",
                        fmt::format("texture({}.{}_{}.{})", syntax.text, syntax.rate.text, syntax.step, syntax.total));
        return std::nullopt;
    case SyntaxKind::name:
        return name(syntax);
    case SyntaxKind::call:
        return call(syntax);
    case SyntaxKind::unary:
        return unary(syntax);
    case SyntaxKind::binary:
        return binary(syntax);
    }
    return std::nullopt;
}

std::optional<Expression> ExpressionChecker::name(const SyntaxExpression& syntax) {
    if (syntax.text == "step") {
        if (scope_.steps.empty()) {
            findings_.error(syntax.offset, "'step' has a meaning inside 'repeat' only");
            return std::nullopt;
        }
        Expression out = node(Kind::number, syntax);
        out.number = scope_.steps.back();
        return out;
    }
    if (Declaration* found = scope_.find(syntax.text)) {
        found->used = true;
        if (found->broken)
            return std::nullopt;
        if (found->kind == Declaration::Kind::curve) {
            findings_.error(syntax.offset, fmt::format("the curve '{}' needs a year", syntax.text),
                            fmt::format("{}(30)", syntax.text));
            return std::nullopt;
        }
        nodes_ += found->nodes;
        if (nodes_ > mostResolvedNodes) {
            findings_.error(syntax.offset, "the expression is too large once its 'let's are put in");
            return std::nullopt;
        }
        Expression out = found->value;
        if (isConstant(out))
            out.place = findings_.source().place(syntax.offset);
        return out;
    }
    if (vocabulary::contains(vocabulary::fieldNames(), syntax.text)) {
        if (!implemented(syntax.text, syntax.offset))
            return std::nullopt;
        return node(Kind::name, syntax);
    }
    if (scope_.brokenNames.count(syntax.text) > 0)
        return std::nullopt;
    if (const vocabulary::Signature* function = vocabulary::signature(syntax.text)) {
        findings_.error(syntax.offset, fmt::format("'{}' needs arguments", syntax.text),
                        fmt::format("it is written {}", function->usage));
        return std::nullopt;
    }
    if (vocabulary::contains(vocabulary::growthModels(), syntax.text)) {
        findings_.error(syntax.offset,
                        fmt::format("the growth model '{}' needs a rate, a step and a total", syntax.text),
                        fmt::format("texture({}.linear_1.20)", syntax.text));
        return std::nullopt;
    }
    std::vector<std::string> candidates = scope_.names();
    for (const auto* more : {&vocabulary::fieldNames(), &vocabulary::functionNames()})
        candidates.insert(candidates.end(), more->begin(), more->end());
    findings_.error(syntax.offset, fmt::format("unknown name '{}'", syntax.text), didYouMean(syntax.text, candidates));
    return std::nullopt;
}

bool ExpressionChecker::implemented(const std::string& function, std::size_t offset) {
    if (context_.functions.count(function) > 0)
        return true;
    findings_.error(offset, fmt::format("'{}' is not there yet in this version", function),
                    "the script needs a later version of the program");
    return false;
}

bool ExpressionChecker::noNamedArguments(const SyntaxExpression& syntax) {
    for (const SyntaxWord& argument : syntax.argumentNames) {
        if (argument.text.empty())
            continue;
        findings_.error(argument.offset, fmt::format("'{}' takes no named arguments", syntax.text));
        return false;
    }
    return true;
}

bool ExpressionChecker::argumentCount(const SyntaxExpression& syntax) {
    const vocabulary::Signature* function = vocabulary::signature(syntax.text);
    const int count = static_cast<int>(syntax.children.size());
    if (count >= function->fewest && (function->most < 0 || count <= function->most))
        return true;
    findings_.error(syntax.offset,
                    fmt::format("'{}' has {} argument{}, which is too {}", syntax.text, count, count == 1 ? "" : "s",
                                count < function->fewest ? "few" : "many"),
                    fmt::format("it is written {}", function->usage));
    return false;
}

std::optional<Expression> ExpressionChecker::call(const SyntaxExpression& syntax) {
    if (syntax.ofFull && syntax.text != "texture") {
        findings_.error(syntax.ofOffset, "'of full' belongs behind a growth pattern",
                        "texture(BD.linear_1.20) of full");
        return std::nullopt;
    }
    if (Declaration* found = scope_.find(syntax.text)) {
        found->used = true;
        if (found->broken)
            return std::nullopt;
        if (found->kind == Declaration::Kind::curve)
            return curveCall(syntax, *found);
        findings_.error(
            syntax.offset, fmt::format("'{}' is not a function", syntax.text),
            fmt::format("leave a blank before the '(' where a map follows, or write {} * (…)", syntax.text));
        return std::nullopt;
    }
    if (syntax.text == "exposure" || syntax.text == "wetness")
        return FieldChecker(*this).exposure(syntax);
    if (syntax.text == "accessibility")
        return FieldChecker(*this).accessibility(syntax);
    const vocabulary::Signature* function = vocabulary::signature(syntax.text);
    if (!function) {
        if (scope_.brokenNames.count(syntax.text) > 0)
            return std::nullopt;
        if (vocabulary::contains(vocabulary::growthModels(), syntax.text)) {
            findings_.error(syntax.offset, "a growth pattern stands inside texture( )",
                            fmt::format("texture({}(…))", syntax.text));
        } else if (vocabulary::contains(vocabulary::fieldNames(), syntax.text)) {
            findings_.error(syntax.offset, fmt::format("'{}' has no arguments", syntax.text),
                            "write the name alone, without brackets");
        } else {
            std::vector<std::string> candidates = vocabulary::functionNames();
            const std::vector<std::string> declared = scope_.names();
            candidates.insert(candidates.end(), declared.begin(), declared.end());
            findings_.error(syntax.offset, fmt::format("unknown function '{}'", syntax.text),
                            didYouMean(syntax.text, candidates));
        }
        return std::nullopt;
    }
    if (!noNamedArguments(syntax) || !argumentCount(syntax) || !implemented(syntax.text, syntax.offset))
        return std::nullopt;
    if (syntax.text == "texture")
        return texture(syntax);
    if (syntax.text == "vertices")
        return vertices(syntax);
    if (syntax.text == "noise" || syntax.text == "turbulence" || syntax.text == "facing")
        return geometric(syntax);
    if (syntax.text == "iso9224")
        return KineticsChecker(*this).iso9224(syntax);
    if (syntax.text == "expansion")
        return KineticsChecker(*this).expansion(syntax);
    return arithmetic(syntax);
}

std::optional<Expression> ExpressionChecker::curveCall(const SyntaxExpression& syntax, const Declaration& declaration) {
    if (!noNamedArguments(syntax))
        return std::nullopt;
    if (syntax.children.size() != 1) {
        findings_.error(syntax.offset, fmt::format("the curve '{}' has one argument, the year", syntax.text),
                        fmt::format("{}(30)", syntax.text));
        return std::nullopt;
    }
    std::optional<Expression> argument = resolveNode(syntax.children[0]);
    if (!argument)
        return std::nullopt;
    if (argument->isLength) {
        findings_.error(syntax.children[0].offset, "a curve's argument is a number without a unit");
        return std::nullopt;
    }
    Expression out = node(Kind::curve, syntax);
    out.isLength = declaration.curve->isLength;
    out.curve = declaration.curve;
    if (isConstant(*argument)) {
        out.kind = Kind::number;
        out.text.clear();
        out.number = declaration.curve->value(argument->number);
        out.curve.reset();
        return out;
    }
    out.children.push_back(std::move(*argument));
    return out;
}

std::optional<Expression> ExpressionChecker::vertices(const SyntaxExpression& syntax) {
    const SyntaxExpression& attribute = syntax.children[0];
    if (attribute.kind != SyntaxKind::name && attribute.kind != SyntaxKind::string) {
        findings_.error(attribute.offset, "vertices needs the name of a per-vertex attribute");
        return std::nullopt;
    }
    if (context_.vertexAttributes && !vocabulary::contains(*context_.vertexAttributes, attribute.text)) {
        std::string remedy = didYouMean(attribute.text, *context_.vertexAttributes);
        if (remedy.empty())
            remedy = context_.vertexAttributes->empty()
                         ? "the model has no per-vertex attributes"
                         : fmt::format("the model has {}", vocabulary::listed(*context_.vertexAttributes));
        findings_.error(attribute.offset, fmt::format("the model has no vertex attribute '{}'", attribute.text),
                        remedy);
        return std::nullopt;
    }
    Expression out = node(Kind::call, syntax);
    out.children.push_back(node(Kind::name, attribute));
    return out;
}

std::optional<Expression> ExpressionChecker::geometric(const SyntaxExpression& syntax) {
    Expression out = node(Kind::call, syntax);
    bool whole = true;
    const auto add = [&](const SyntaxExpression& argument, std::optional<double> value, bool isLength) {
        if (!value) {
            whole = false;
            return;
        }
        Expression number = node(Kind::number, argument);
        number.number = *value;
        number.isLength = isLength;
        out.children.push_back(std::move(number));
    };
    if (syntax.text == "facing") {
        double size = 0.0;
        for (const SyntaxExpression& argument : syntax.children) {
            add(argument, plainNumber(argument, "a component of the direction"), false);
            if (whole)
                size = std::max(size, std::abs(out.children.back().number));
        }
        if (whole && size == 0.0) {
            findings_.error(syntax.offset, "the direction (0, 0, 0) faces nowhere");
            whole = false;
        }
    } else {
        add(syntax.children[0], lengthPositive(syntax.children[0], "the size"), true);
        if (syntax.text == "turbulence")
            add(syntax.children[1], wholeNumber(syntax.children[1], "the number of octaves", 1, 16), false);
    }
    if (!whole)
        return std::nullopt;
    return out;
}

} // namespace patina
