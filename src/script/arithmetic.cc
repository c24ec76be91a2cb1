// Operators and functions of numbers: kinds of quantity and folding of constants.

#include "script/expression_checker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina {

using Kind = Expression::Kind;

namespace {

/// The value of an operator or function of constants. Lengths are µm throughout, so they need no care here.
double evaluate(const Expression& expression) {
    const auto at = [&expression](std::size_t i) { return expression.children[i].number; };
    const std::string& what = expression.text;
    if (expression.kind == Kind::unary)
        return -at(0);
    if (what == "+")
        return at(0) + at(1);
    if (what == "-")
        return at(0) - at(1);
    if (what == "*")
        return at(0) * at(1);
    if (what == "/")
        return at(0) / at(1);
    if (what == "clamp")
        return std::min(std::max(at(0), at(1)), at(2));
    if (what == "mix")
        return at(0) + (at(1) - at(0)) * at(2);
    if (what == "pow")
        return std::pow(at(0), at(1));
    if (what == "smoothstep") {
        const double share = std::min(std::max((at(2) - at(0)) / (at(1) - at(0)), 0.0), 1.0);
        return share * share * (3.0 - 2.0 * share);
    }
    double out = at(0);
    for (std::size_t i = 1; i < expression.children.size(); ++i)
        out = what == "min" ? std::min(out, at(i)) : std::max(out, at(i));
    return out;
}

} // namespace

std::optional<Expression> ExpressionChecker::folded(Expression expression) {
    for (const Expression& child : expression.children)
        if (child.kind != Kind::number)
            return expression;
    const double value = evaluate(expression);
    expression.kind = Kind::number;
    expression.number = value;
    expression.text.clear();
    expression.children.clear();
    return expression;
}

std::optional<Expression> ExpressionChecker::unary(const SyntaxExpression& syntax) {
    std::optional<Expression> child = resolveNode(syntax.children[0]);
    if (!child)
        return std::nullopt;
    Expression out = node(Kind::unary, syntax);
    out.isLength = child->isLength;
    out.children.push_back(std::move(*child));
    return folded(std::move(out));
}

std::optional<Expression> ExpressionChecker::binary(const SyntaxExpression& syntax) {
    std::optional<Expression> left = resolveNode(syntax.children[0]);
    std::optional<Expression> right = resolveNode(syntax.children[1]);
    if (!left || !right)
        return std::nullopt;
    Expression out = node(Kind::binary, syntax);
    if (syntax.text == "+" || syntax.text == "-") {
        if (left->isLength != right->isLength) {
            findings_.error(
                syntax.offset,
                fmt::format("a length and a plain number cannot be {}", syntax.text == "+" ? "added" : "subtracted"),
                "give both a unit, or neither");
            return std::nullopt;
        }
        out.isLength = left->isLength;
    } else if (syntax.text == "*") {
        if (left->isLength && right->isLength) {
            findings_.error(syntax.offset, "two lengths are multiplied: the result is an area, not a length or factor");
            return std::nullopt;
        }
        out.isLength = left->isLength || right->isLength;
    } else {
        if (right->isLength && !left->isLength) {
            findings_.error(syntax.offset, "a plain number is divided by a length",
                            "divide a length by a length to get a factor");
            return std::nullopt;
        }
        if (right->kind == Kind::number && right->number == 0.0) {
            findings_.error(syntax.offset, "division by zero");
            return std::nullopt;
        }
        out.isLength = left->isLength && !right->isLength;
    }
    out.children.reserve(2);
    out.children.push_back(std::move(*left));
    out.children.push_back(std::move(*right));
    std::optional<Expression> value = folded(std::move(out));
    if (value && value->kind == Kind::number && !std::isfinite(value->number)) {
        findings_.error(syntax.offset, "the number is too large");
        return std::nullopt;
    }
    return value;
}

std::optional<Expression> ExpressionChecker::arithmetic(const SyntaxExpression& syntax) {
    Expression out = node(Kind::call, syntax);
    bool whole = true;
    for (const SyntaxExpression& argument : syntax.children) {
        std::optional<Expression> child = resolveNode(argument);
        whole = whole && child.has_value();
        if (child)
            out.children.push_back(std::move(*child));
    }
    if (!whole)
        return std::nullopt;
    const auto isLength = [&out](std::size_t i) { return out.children[i].isLength; };
    const auto error = [&](std::size_t offset, std::string message) {
        findings_.error(offset, std::move(message));
        return std::nullopt;
    };
    // The arguments that must be of one kind: all of them but the share of mix.
    const std::size_t alike = syntax.text == "mix" ? 2 : out.children.size();
    for (std::size_t i = 1; i < alike; ++i)
        if (isLength(i) != isLength(0))
            return error(syntax.children[i].offset,
                         fmt::format("the arguments of '{}' must be all lengths or all plain numbers", syntax.text));
    if (syntax.text == "mix" && isLength(2))
        return error(syntax.children[2].offset, "the share of mix is a number without a unit");
    if (syntax.text == "pow" && isLength(0))
        return error(syntax.offset, "pow takes numbers without a unit");
    const auto constantAt = [&out](std::size_t i) { return out.children[i].kind == Kind::number; };
    if (syntax.text == "smoothstep" && constantAt(0) && constantAt(1) &&
        out.children[0].number == out.children[1].number)
        return error(syntax.children[1].offset, "smoothstep begins and ends at the same value");
    if (syntax.text == "clamp" && constantAt(1) && constantAt(2) && out.children[1].number > out.children[2].number)
        return error(syntax.children[2].offset, "the highest value of clamp is below the lowest");
    out.isLength = isLength(0) && syntax.text != "smoothstep";
    std::optional<Expression> value = folded(std::move(out));
    if (value && value->kind == Kind::number && !std::isfinite(value->number))
        return error(syntax.offset, fmt::format("'{}' has no value here", syntax.text));
    return value;
}

} // namespace patina
