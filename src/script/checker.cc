#include "script/checker.h"

#include "base/atomic_file.h"
#include "base/names.h"
#include "script/expression_checker.h"
#include "script/findings.h"
#include "script/grammar.h"
#include "script/scope.h"
#include "script/statement_checker.h"
#include "script/syntax.h"
#include "script/vocabulary.h"

#include <fmt/format.h>

namespace patina {

namespace {

/// What `repeat` may unroll to; more is a slip of the keyboard.
constexpr std::size_t mostStatements = 100000;

std::set<std::string> asSet(const std::vector<std::string>& words) {
    return {words.begin(), words.end()};
}

class Checker {
  public:
    Checker(const SyntaxTree& tree, const CheckContext& context)
        : tree_(tree), context_(context), findings_(tree.source), expressions_(context, findings_, scope_),
          statements_(context, findings_, scope_) {
        for (const Diagnostic& finding : tree.diagnostics)
            findings_.add(finding);
        scope_.brokenNames = tree.brokenNames;
    }

    Program run() {
        program_.file = tree_.source.file();
        program_.name = std::filesystem::path(program_.file).stem().string();
        program_.sourceText = tree_.source.text();
        block(tree_.statements);
        if (!begun_ && !tree_.brokenBeginning)
            findings_.errorAt({program_.file, 0, 0}, "the script begins nothing",
                              "it needs a statement such as: new copper");
        unknownSettings();
        unusedNames(scope_.innermost());
        if (findings_.errorCount() > 0)
            throw ScriptError(findings_.sorted());
        program_.warnings = findings_.sorted();
        return std::move(program_);
    }

  private:
    void block(const std::vector<SyntaxStatement>& statements) {
        for (const SyntaxStatement& statement : statements) {
            full_ = full_ || findings_.errorCount() > static_cast<int>(mostFindings);
            if (full_)
                return;
            if (++visited_ > 2 * mostStatements) {
                findings_.error(statement.offset,
                                fmt::format("the script comes to more than {} statements", mostStatements));
                full_ = true;
                return;
            }
            if (statement.word == "let")
                let(statement);
            else if (statement.word == "param")
                parameter(statement);
            else if (statement.word == "curve")
                curve(statement);
            else if (statement.word == "seed")
                seed(statement);
            else if (statement.word == "repeat")
                repeat(statement);
            else
                operation(statement);
        }
    }

    void operation(const SyntaxStatement& syntax) {
        const bool begins = syntax.word == "new" || syntax.word == "open";
        if (begins && begun_) {
            findings_.error(syntax.offset, fmt::format("'{}' begins the object a second time", syntax.word),
                            fmt::format("it began in line {}", tree_.source.lineNumber(*begun_)));
            return;
        }
        if (begins && !scope_.steps.empty())
            findings_.error(syntax.offset, fmt::format("'{}' cannot be repeated", syntax.word),
                            "it belongs before the 'repeat'");
        if (begins)
            begun_ = syntax.offset;
        else if (!begun_ && !tree_.brokenBeginning) {
            findings_.error(syntax.offset, fmt::format("'{}' comes before the object has begun", syntax.word),
                            "the first statement is 'new METAL' or 'open \"FILE.vdb\"'");
            begun_ = syntax.offset;
        }
        std::optional<Statement> statement = statements_.resolve(syntax);
        if (!statement)
            return;
        statement->repeatStep = scope_.steps.empty() ? 0 : scope_.steps.back();
        if (program_.statements.size() >= mostStatements) {
            findings_.error(syntax.offset, fmt::format("the script comes to more than {} statements", mostStatements));
            full_ = true;
            return;
        }
        program_.statements.push_back(std::move(*statement));
    }

    /// Whether the name may be declared; reports why not.
    bool declarable(const SyntaxWord& name) {
        if (vocabulary::isReserved(name.text) || vocabulary::contains(vocabulary::fieldNames(), name.text) ||
            vocabulary::contains(vocabulary::functionNames(), name.text) ||
            vocabulary::contains(vocabulary::growthModels(), name.text)) {
            findings_.error(name.offset, fmt::format("'{}' is a word of the language", name.text),
                            "choose another name");
            scope_.brokenNames.insert(name.text);
            return false;
        }
        if (const Declaration* before = scope_.find(name.text)) {
            findings_.error(name.offset, fmt::format("the name '{}' is taken", name.text),
                            fmt::format("it was declared in line {}", tree_.source.lineNumber(before->offset)));
            return false;
        }
        return true;
    }

    void let(const SyntaxStatement& syntax) {
        const SyntaxWord& name = syntax.names.at(0);
        std::optional<Expression> value = expressions_.resolve(syntax.values.at(0));
        if (!declarable(name))
            return;
        Declaration declaration;
        declaration.kind = Declaration::Kind::map;
        declaration.offset = name.offset;
        declaration.broken = !value;
        if (value) {
            declaration.nodes = ExpressionChecker::nodeCount(*value);
            declaration.value = std::move(*value);
        }
        scope_.declare(name.text, std::move(declaration));
    }

    bool outsideRepeat(const SyntaxStatement& syntax) {
        if (scope_.steps.empty())
            return true;
        findings_.error(syntax.offset, fmt::format("'{}' cannot be repeated", syntax.word),
                        "it belongs before the 'repeat'");
        return false;
    }

    void parameter(const SyntaxStatement& syntax) {
        const SyntaxWord& name = syntax.names.at(0);
        if (!outsideRepeat(syntax) || !declarable(name))
            return;
        Declaration declaration;
        declaration.kind = Declaration::Kind::parameter;
        declaration.offset = name.offset;
        std::optional<Expression> value = expressions_.resolve(syntax.values.at(0));
        if (value && value->kind != Expression::Kind::number) {
            findings_.error(syntax.values[0].offset, "a parameter is a number, this varies over the surface",
                            fmt::format("let {} = …", name.text));
            value.reset();
        }
        bool wasSet = false;
        if (const auto setting = context_.settings.find(name.text); setting != context_.settings.end()) {
            parametersSeen_.insert(name.text);
            wasSet = true;
            value = settingValue(setting->first, setting->second);
        }
        declaration.broken = !value;
        if (value) {
            program_.parameters.push_back({name.text, value->number, value->isLength, wasSet});
            declaration.value = std::move(*value);
        }
        scope_.declare(name.text, std::move(declaration));
    }

    std::optional<Expression> settingValue(const std::string& name, const std::string& text) {
        Expression value;
        value.place.file = fmt::format("--set {}={}", name, text);
        try {
            const SyntaxExpression quantity = parseQuantity(text);
            value.number = quantity.number;
            value.isLength = quantity.isLength;
            return value;
        } catch (const SyntaxFailure& failure) {
            findings_.errorAt(value.place, failure.message,
                              failure.remedy.empty() ? "a number with or without a unit, such as 0.3 or 2mm"
                                                     : failure.remedy);
            return std::nullopt;
        }
    }

    void curve(const SyntaxStatement& syntax) {
        const SyntaxWord& name = syntax.names.at(0);
        if (!outsideRepeat(syntax) || !declarable(name))
            return;
        auto made = std::make_shared<Curve>();
        made->name = name.text;
        made->isSmooth = syntax.smooth;
        bool good = true;
        for (std::size_t i = 0; i < syntax.values.size(); ++i)
            good = curvePoint(syntax.values[i], i == 0, *made) && good;
        Declaration declaration;
        declaration.kind = Declaration::Kind::curve;
        declaration.offset = name.offset;
        declaration.broken = !good;
        if (good)
            program_.curves.push_back(*made);
        declaration.curve = std::move(made);
        scope_.declare(name.text, std::move(declaration));
    }

    bool curvePoint(const SyntaxExpression& point, bool isFirst, Curve& curve) {
        if (point.children.size() != 2) {
            findings_.error(point.offset, "a point of a curve has two numbers, (year, value)");
            return false;
        }
        const auto year = expressions_.plainNumber(point.children[0], "the year");
        const std::optional<Expression> value = expressions_.resolve(point.children[1]);
        if (!year || !value)
            return false;
        if (value->kind != Expression::Kind::number) {
            findings_.error(point.children[1].offset, "a curve's value is a number, this varies over the surface");
            return false;
        }
        if (isFirst)
            curve.isLength = value->isLength;
        else if (curve.isLength != value->isLength) {
            findings_.error(point.children[1].offset, "the values of a curve must be all lengths or all plain numbers");
            return false;
        }
        if (!curve.points.empty() && *year <= curve.points.back().first) {
            const double before = curve.points.back().first;
            findings_.error(point.offset,
                            *year == before
                                ? fmt::format("the curve '{}' has two points at year {:g}", curve.name, *year)
                                : fmt::format("the curve '{}' is not sorted: year {:g} stands behind year {:g}",
                                              curve.name, *year, before),
                            "the years of a curve's points must increase");
            return false;
        }
        curve.points.emplace_back(*year, value->number);
        return true;
    }

    void seed(const SyntaxStatement& syntax) {
        if (!outsideRepeat(syntax))
            return;
        if (seedOffset_) {
            findings_.error(syntax.offset, "the seed is given twice",
                            fmt::format("it was given in line {}", tree_.source.lineNumber(*seedOffset_)));
            return;
        }
        seedOffset_ = syntax.offset;
        constexpr double largestExactInteger = 9007199254740991.0; // 2^53 - 1
        if (const auto value = expressions_.wholeNumber(syntax.values.at(0), "the seed", 0, largestExactInteger))
            program_.seed = static_cast<std::uint64_t>(*value);
    }

    void repeat(const SyntaxStatement& syntax) {
        const auto count = expressions_.wholeNumber(syntax.values.at(0), "the number of repetitions", 1, 100000);
        const int last = count ? static_cast<int>(*count) : 1;
        for (int step = 1; step <= last && !full_; ++step) {
            const int errorsBefore = findings_.errorCount();
            scope_.push();
            scope_.steps.push_back(step);
            block(syntax.body);
            scope_.steps.pop_back();
            unusedNames(scope_.pop());
            if (findings_.errorCount() > errorsBefore)
                break; // one report per error is enough
            ++visited_;
        }
    }

    void unknownSettings() {
        std::vector<std::string> known;
        for (const auto& [name, declaration] : scope_.innermost())
            if (declaration.kind == Declaration::Kind::parameter)
                known.push_back(name);
        for (const auto& [name, value] : context_.settings) {
            if (parametersSeen_.count(name) > 0 || tree_.brokenNames.count(name) > 0)
                continue;
            std::string remedy = didYouMean(name, known);
            if (remedy.empty())
                remedy = known.empty() ? std::string("the script has no parameters")
                                       : fmt::format("the script's parameters: {}", vocabulary::listed(known));
            findings_.errorAt({fmt::format("--set {}={}", name, value), 0, 0},
                              fmt::format("the script has no parameter '{}'", name), remedy);
        }
    }

    void unusedNames(const std::map<std::string, Declaration>& declarations) {
        for (const auto& [name, declaration] : declarations)
            if (!declaration.used && !declaration.broken && !full_)
                findings_.warning(declaration.offset, fmt::format("'{}' is never used", name));
    }

    const SyntaxTree& tree_;
    const CheckContext& context_;
    Findings findings_;
    Scope scope_;
    ExpressionChecker expressions_;
    StatementChecker statements_;
    Program program_;
    std::optional<std::size_t> begun_;
    std::optional<std::size_t> seedOffset_;
    std::set<std::string> parametersSeen_;
    std::size_t visited_ = 0; ///< statements and repetitions checked so far
    bool full_ = false;
};

} // namespace

std::set<std::string> CheckContext::allOperators() {
    return asSet(vocabulary::operatorWords());
}

std::set<std::string> CheckContext::allFunctions() {
    std::set<std::string> all = asSet(vocabulary::functionNames());
    all.insert(vocabulary::fieldNames().begin(), vocabulary::fieldNames().end());
    return all;
}

std::set<std::string> CheckContext::allGrowthModels() {
    return asSet(vocabulary::growthModels());
}

std::set<std::string> CheckContext::allGrowthArguments() {
    std::set<std::string> all;
    for (const std::string& model : vocabulary::growthModels())
        for (const std::string& argument : vocabulary::growthArguments(model))
            all.insert(argument);
    return all;
}

std::set<std::string> CheckContext::allClauses() {
    return asSet(vocabulary::optionalClauses());
}

Program check(const SyntaxTree& tree, const CheckContext& context) {
    return Checker(tree, context).run();
}

Program readProgram(const std::string& text, const std::string& file, const CheckContext& context) {
    return check(parse(text, file), context);
}

Program readProgramFile(const std::filesystem::path& path, const CheckContext& context) {
    return readProgram(readTextFile(path), path.string(), context);
}

} // namespace patina
