#include "script/grammar.h"

#include "base/names.h"
#include "base/units.h"
#include "script/grammar_rules.h"
#include "script/vocabulary.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

namespace patina {

namespace pegtl = tao::pegtl;

namespace {

using Node = pegtl::parse_tree::node;
using Kind = SyntaxExpression::Kind;

bool isWordByte(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/// Statements of more than this many numbers and names are not a person's.
constexpr int mostExpressionNodes = 2000;

/// Turns the parse tree of one statement into its syntax. Deep recursion is bounded by deepestBrackets and, for the
/// left-leaning chains of `a + b + c …`, by mostExpressionNodes.
class TreeReader {
  public:
    explicit TreeReader(const char* origin) : origin_(origin) {}

    SyntaxStatement statement(const Node& root) {
        SyntaxStatement out;
        for (const auto& child : root.children)
            part(*child, out);
        return out;
    }

    SyntaxExpression signedQuantity(const Node& root) {
        SyntaxExpression out;
        bool negative = false;
        for (const auto& child : root.children) {
            if (child->is_type<rules::sign>())
                negative = child->string_view() == "-";
            else
                out = quantity(*child);
        }
        if (negative)
            out.number = -out.number;
        return out;
    }

  private:
    std::size_t offset(const Node& node) const { return static_cast<std::size_t>(node.string_view().data() - origin_); }
    SyntaxWord wordOf(const Node& node) const { return {std::string(node.string_view()), offset(node)}; }

    void part(const Node& node, SyntaxStatement& out) {
        if (node.is_type<rules::material>() || node.is_type<rules::declared>() || node.is_type<rules::target>())
            out.names.push_back(wordOf(node));
        else if (node.is_type<rules::fileName>())
            out.names.push_back({std::string(node.children.at(0)->string_view()), offset(node)});
        else if (node.is_type<rules::value>())
            out.values.push_back(chain(node));
        else if (node.is_type<rules::map>())
            out.map = chain(node);
        else if (node.is_type<rules::point>())
            out.values.push_back(group(node));
        else if (node.is_type<rules::areaMark>())
            out.area = true;
        else if (node.is_type<rules::smoothMark>())
            out.smooth = true;
        else if (isClause(node))
            out.clauses.push_back(clause(node));
    }

    static bool isClause(const Node& node) {
        return node.is_type<rules::asClause>() || node.is_type<rules::byClause>() || node.is_type<rules::andClause>() ||
               node.is_type<rules::aboveClause>() || node.is_type<rules::windowClause>() ||
               node.is_type<rules::ofClause>() || node.is_type<rules::tangentClause>() ||
               node.is_type<rules::globalClause>() || node.is_type<rules::everywhereClause>();
    }

    SyntaxClause clause(const Node& node) {
        SyntaxClause out;
        out.offset = offset(node);
        const std::string_view text = node.string_view();
        std::size_t length = 0;
        while (length < text.size() && ((text[length] >= 'a' && text[length] <= 'z') || text[length] == '-'))
            ++length;
        out.word = std::string(text.substr(0, length));
        for (const auto& child : node.children) {
            if (child->is_type<rules::label>() || child->is_type<rules::material>())
                out.names.push_back(wordOf(*child));
            else
                out.values.push_back(chain(*child));
        }
        return out;
    }

    SyntaxExpression leaf(Kind kind, const Node& node) {
        if (++nodes_ > mostExpressionNodes)
            throw SyntaxFailure{offset(node), "the statement is too long", "use 'let NAME = …' for parts of it"};
        SyntaxExpression out;
        out.kind = kind;
        out.offset = offset(node);
        return out;
    }

    /// `a op b op c` from the left; also the wrappers that hold one child.
    SyntaxExpression chain(const Node& node) {
        if (node.is_type<rules::factor>())
            return factor(node);
        SyntaxExpression left = operand(*node.children.at(0));
        for (std::size_t i = 1; i + 1 < node.children.size(); i += 2) {
            SyntaxExpression whole = leaf(Kind::binary, *node.children[i]);
            whole.text = std::string(node.children[i]->string_view());
            whole.children.reserve(2);
            whole.children.push_back(std::move(left));
            whole.children.push_back(operand(*node.children[i + 1]));
            left = std::move(whole);
        }
        return left;
    }

    SyntaxExpression operand(const Node& node) { return node.is_type<rules::factor>() ? factor(node) : chain(node); }

    SyntaxExpression factor(const Node& node) {
        bool negative = false;
        SyntaxExpression out;
        for (const auto& child : node.children) {
            if (child->is_type<rules::sign>()) {
                negative ^= child->string_view() == "-";
            } else if (child->is_type<rules::ofFull>()) {
                out.ofFull = true;
                out.ofOffset = offset(*child);
            } else {
                out = primary(*child);
            }
        }
        if (!negative)
            return out;
        SyntaxExpression minus = leaf(Kind::unary, node);
        minus.text = "-";
        minus.children.push_back(std::move(out));
        return minus;
    }

    SyntaxExpression primary(const Node& node) {
        if (node.is_type<rules::quantity>())
            return quantity(node);
        if (node.is_type<rules::quoted>()) {
            SyntaxExpression out = leaf(Kind::string, node);
            out.text = std::string(node.children.at(0)->string_view());
            return out;
        }
        if (node.is_type<rules::group>())
            return group(node);
        if (node.is_type<rules::growthShort>())
            return growthShort(node);
        if (node.is_type<rules::call>())
            return call(node);
        SyntaxExpression out = leaf(Kind::name, node);
        out.text = std::string(node.string_view());
        return out;
    }

    SyntaxExpression quantity(const Node& node) {
        SyntaxExpression out = leaf(Kind::number, node);
        const Node& digits = *node.children.at(0);
        out.number = std::strtod(std::string(digits.string_view()).c_str(), nullptr);
        if (!std::isfinite(out.number))
            throw SyntaxFailure{out.offset, "the number is too large", {}};
        if (node.children.size() < 2)
            return out;
        std::string unit(node.children[1]->string_view());
        if (unit.compare(0, 2, "\xCE\xBC") == 0)
            unit.replace(0, 2, "\xC2\xB5");
        const auto micrometres = micrometresPerUnit(unit);
        if (!micrometres)
            throw SyntaxFailure{offset(*node.children[1]), fmt::format("unknown unit '{}'", unit),
                                "the units are nm, um (or µm), mm, cm and m"};
        out.number *= *micrometres;
        out.isLength = true;
        return out;
    }

    /// `(a)` is a; `(a, b)` a tuple.
    SyntaxExpression group(const Node& node) {
        const bool isPoint = node.is_type<rules::point>();
        if (node.children.size() == 1 && !isPoint)
            return chain(*node.children[0]);
        SyntaxExpression out = leaf(Kind::tuple, node);
        for (const auto& child : node.children)
            out.children.push_back(chain(*child));
        return out;
    }

    SyntaxExpression growthShort(const Node& node) {
        SyntaxExpression out = leaf(Kind::growthShort, node);
        out.text = std::string(node.children.at(0)->string_view());
        out.rate = wordOf(*node.children.at(1));
        out.step = wholeNumber(*node.children.at(2));
        out.total = wholeNumber(*node.children.at(3));
        out.stepOffset = offset(*node.children.at(2));
        out.totalOffset = offset(*node.children.at(3));
        return out;
    }

    int wholeNumber(const Node& node) const {
        if (node.string_view().size() > 9)
            throw SyntaxFailure{offset(node), "the number is too large", {}};
        return std::atoi(std::string(node.string_view()).c_str());
    }

    SyntaxExpression call(const Node& node) {
        SyntaxExpression out = leaf(Kind::call, node);
        out.text = std::string(node.children.at(0)->string_view());
        for (std::size_t i = 1; i < node.children.size(); ++i) {
            const Node& argument = *node.children[i];
            SyntaxWord argumentName;
            if (argument.children.size() > 1)
                argumentName = wordOf(*argument.children[0]);
            out.argumentNames.push_back(std::move(argumentName));
            out.children.push_back(chain(*argument.children.back()));
        }
        return out;
    }

    const char* origin_;
    int nodes_ = 0;
};

template <typename Rule>
std::unique_ptr<Node> parseTree(std::string_view masked, std::size_t begin, std::size_t end) {
    pegtl::memory_input<pegtl::tracking_mode::eager> input(masked.data() + begin, masked.data() + end, "");
    try {
        auto root = pegtl::parse_tree::parse<Rule, rules::selector, pegtl::nothing, rules::control>(input);
        if (!root)
            throw SyntaxFailure{begin, "expected a statement", {}};
        return root;
    } catch (const pegtl::parse_error& error) {
        const std::size_t offset = begin + error.positions().front().byte;
        const std::string found = SourceText::describeToken(masked.substr(0, end), offset);
        throw SyntaxFailure{offset, fmt::format("{}, found {}", error.message(), found), {}};
    }
}

} // namespace

SyntaxStatement parseStatement(std::string_view masked, std::size_t begin, std::size_t end) {
    const std::string_view text = masked.substr(begin, end - begin);
    std::size_t length = 0;
    while (length < text.size() && isWordByte(text[length]))
        ++length;
    const std::string first(text.substr(0, length));
    if (length == 0)
        throw SyntaxFailure{
            begin, fmt::format("expected a statement, found {}", SourceText::describeToken(text, 0)), {}};
    if (!vocabulary::contains(vocabulary::statementWords(), first)) {
        std::string remedy = didYouMean(first, vocabulary::statementWords());
        if (remedy.empty())
            remedy = fmt::format("a statement begins with {}", vocabulary::listed(vocabulary::statementWords()));
        throw SyntaxFailure{begin, fmt::format("unknown statement '{}'", first.substr(0, 60)), remedy};
    }
    const auto root = parseTree<rules::wholeStatement>(masked, begin, end);
    SyntaxStatement out = TreeReader(masked.data()).statement(*root);
    out.word = first;
    out.offset = begin;
    bool blank = false;
    for (const char c : text) {
        if (c == ' ' || c == '\t' || c == '\r') {
            blank = true;
            continue;
        }
        if (blank)
            out.text += ' ';
        blank = false;
        out.text += c;
    }
    return out;
}

SyntaxExpression parseQuantity(std::string_view text) {
    const auto root = parseTree<rules::wholeQuantity>(text, 0, text.size());
    return TreeReader(text.data()).signedQuantity(*root);
}

} // namespace patina
