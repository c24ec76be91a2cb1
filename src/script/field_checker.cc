// accessibility(6mm, soft=2mm, global=yes), exposure and wetness(sky=overcast, latitude=45, months=(4, 9), rays=256,
// ground=yes).

#include "base/names.h"
#include "operators/fields/field_store.h"
#include "script/expression_checker.h"
#include "script/vocabulary.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

namespace patina {

using SyntaxKind = SyntaxExpression::Kind;

namespace {

const char* const exposureUsage =
    "sky=overcast, latitude=45, months=(4, 9), hours=(8, 18), clouds=0.5, sun=yes, north=(0, 0, -1), ground=yes, "
    "rays=256";

const std::vector<std::string>& exposureArguments() {
    static const std::vector<std::string> names = {"sky", "latitude", "months", "hours", "clouds",
                                                   "sun", "north",    "ground", "rays"};
    return names;
}

} // namespace

std::optional<bool> FieldChecker::yesOrNo(const SyntaxExpression& syntax, const std::string& name) {
    if (syntax.kind == SyntaxKind::name && (syntax.text == "yes" || syntax.text == "no"))
        return syntax.text == "yes";
    expressions_.findings_.error(syntax.offset, fmt::format("{} is yes or no", name), fmt::format("{}=yes", name));
    return std::nullopt;
}

std::optional<std::vector<double>> FieldChecker::numbers(const SyntaxExpression& syntax, std::size_t count,
                                                         const std::string& what, const std::string& example) {
    if (syntax.kind != SyntaxKind::tuple || syntax.children.size() != count) {
        expressions_.findings_.error(syntax.offset, fmt::format("{} has {} numbers", what, count), example);
        return std::nullopt;
    }
    std::vector<double> values;
    for (const SyntaxExpression& child : syntax.children) {
        const auto number = expressions_.plainNumber(child, "a number of " + what);
        if (!number)
            return std::nullopt;
        values.push_back(*number);
    }
    return values;
}

bool FieldChecker::sky(const SyntaxExpression& syntax, ExposureRequest& out) {
    if (syntax.kind == SyntaxKind::name) {
        out.light.sky = skyNamed(syntax.text);
        if (out.light.sky)
            return true;
        std::string remedy = didYouMean(syntax.text, skyNames());
        if (remedy.empty())
            remedy = fmt::format("skies are {} and the types 1 to 16 of CIE S 011", vocabulary::listed(skyNames()));
        expressions_.findings_.error(syntax.offset, fmt::format("unknown sky '{}'", syntax.text), remedy);
        return false;
    }
    const auto type = expressions_.wholeNumber(syntax, "the type of the sky (CIE S 011; 16 is overcast)", 1, 16);
    if (type)
        out.light.sky = static_cast<int>(*type);
    return type.has_value();
}

bool FieldChecker::argument(const std::string& name, const SyntaxExpression& value, ExposureRequest& out) {
    Findings& findings = expressions_.findings_;
    SunAndSky& light = out.light;
    if (name == "sky")
        return sky(value, out);
    if (name == "latitude") {
        const auto degrees = expressions_.plainNumber(value, "the latitude");
        if (!degrees)
            return false;
        if (!(std::abs(*degrees) <= 90.0)) {
            findings.error(value.offset, fmt::format("the latitude {:g} is beyond 90 degrees", *degrees),
                           "-90 is the south pole, 90 the north");
            return false;
        }
        light.latitudeDegrees = *degrees;
        return true;
    }
    if (name == "months") {
        const auto months = numbers(value, 2, "the span of months", "months=(4, 9) is April to September");
        if (!months)
            return false;
        for (const double month : *months)
            if (month < 1.0 || month > 12.0 || month != std::floor(month)) {
                findings.error(value.offset, fmt::format("there is no month {:g}", month), "months go from 1 to 12");
                return false;
            }
        light.firstMonth = static_cast<int>((*months)[0]);
        light.lastMonth = static_cast<int>((*months)[1]);
        return true;
    }
    if (name == "hours") {
        const auto hours = numbers(value, 2, "the span of hours", "hours=(8, 18), solar time");
        if (!hours)
            return false;
        if (!((*hours)[0] >= 0.0 && (*hours)[1] <= 24.0 && (*hours)[0] < (*hours)[1])) {
            findings.error(value.offset, "hours go from 0 to 24, the first before the last");
            return false;
        }
        light.firstHour = (*hours)[0];
        light.lastHour = (*hours)[1];
        return true;
    }
    if (name == "clouds") {
        const auto clouds = expressions_.fraction(value, "clouds");
        if (clouds)
            light.clouds = *clouds;
        return clouds.has_value();
    }
    if (name == "north") {
        const auto north = numbers(value, 3, "the direction of north", "north=(0, 0, -1)");
        if (!north)
            return false;
        out.north = Imath::V3d((*north)[0], (*north)[1], (*north)[2]);
        if (out.north->length() == 0.0) {
            findings.error(value.offset, "the direction (0, 0, 0) is not north");
            return false;
        }
        if (const auto& up = expressions_.context_.up) {
            const Imath::V3d axis((*up)[0], (*up)[1], (*up)[2]);
            if (axis.cross(*out.north).length() <= 1e-6 * axis.length() * out.north->length()) {
                findings.error(value.offset, "north lies along the model's up axis",
                               "give a direction that is level, or the model's axis by --up");
                return false;
            }
        }
        return true;
    }
    if (name == "rays") {
        const auto rays = expressions_.wholeNumber(value, "the number of rays", 1, 65536);
        if (rays)
            out.rays = static_cast<int>(*rays);
        return rays.has_value();
    }
    const auto answer = yesOrNo(value, name);
    if (answer)
        (name == "sun" ? light.sun : out.ground) = *answer;
    return answer.has_value();
}

std::optional<Expression> FieldChecker::exposure(const SyntaxExpression& syntax) {
    Findings& findings = expressions_.findings_;
    auto request = std::make_shared<ExposureRequest>();
    std::set<std::string> given;
    bool good = true;
    for (std::size_t i = 0; i < syntax.children.size(); ++i) {
        const SyntaxWord& name = syntax.argumentNames[i];
        if (name.text.empty()) {
            findings.error(syntax.children[i].offset, fmt::format("the arguments of '{}' have names", syntax.text),
                           fmt::format("it is written {}({})", syntax.text, exposureUsage));
            good = false;
        } else if (!vocabulary::contains(exposureArguments(), name.text)) {
            std::string remedy = didYouMean(name.text, exposureArguments());
            if (remedy.empty())
                remedy = fmt::format("it takes {}", vocabulary::listed(exposureArguments()));
            findings.error(name.offset, fmt::format("'{}' has no argument '{}'", syntax.text, name.text), remedy);
            good = false;
        } else if (!given.insert(name.text).second) {
            findings.error(name.offset, fmt::format("'{}' is given twice", name.text));
            good = false;
        } else {
            good = argument(name.text, syntax.children[i], *request) && good;
        }
    }
    if (!good || !expressions_.implemented(syntax.text, syntax.offset))
        return std::nullopt;
    // A sky by itself is that sky; whoever says where and when wants the sun as well.
    if (given.count("sky") > 0 && given.count("sun") == 0)
        request->light.sun = given.count("latitude") + given.count("months") + given.count("hours") > 0;
    Expression out = expressions_.node(Expression::Kind::name, syntax);
    out.exposure = std::move(request);
    return out;
}

std::optional<Expression> FieldChecker::accessibility(const SyntaxExpression& syntax) {
    Findings& findings = expressions_.findings_;
    const SyntaxExpression *radius = nullptr, *soft = nullptr;
    bool global = false, good = true;
    for (std::size_t i = 0; i < syntax.children.size(); ++i) {
        const SyntaxWord& name = syntax.argumentNames[i];
        if (name.text.empty() && i == 0) {
            radius = &syntax.children[i];
        } else if (name.text == "soft") {
            soft = &syntax.children[i];
        } else if (name.text == "global") {
            const auto answer = yesOrNo(syntax.children[i], "global");
            good = answer.has_value() && good;
            global = answer.value_or(false);
        } else {
            findings.error(name.text.empty() ? syntax.children[i].offset : name.offset,
                           name.text.empty() ? "'accessibility' has one radius"
                                             : fmt::format("'accessibility' has no argument '{}'", name.text),
                           "it is written accessibility(radius), accessibility(radius, soft=LENGTH, global=yes)");
            good = false;
        }
    }
    if (!radius && good) {
        findings.error(syntax.offset, "'accessibility' needs a radius", "it is written accessibility(radius)");
        good = false;
    }
    if (!good || !expressions_.implemented("accessibility", syntax.offset))
        return std::nullopt;
    const auto um = expressions_.lengthPositive(*radius, "the radius");
    const auto softUm = soft ? expressions_.lengthPositive(*soft, "how soft it is") : std::optional<double>(0.0);
    if (!um || !softUm)
        return std::nullopt;
    if (*softUm > *um) {
        findings.error(soft->offset, "a hand is no softer than it is wide",
                       "give `soft` a length up to that of the radius");
        return std::nullopt;
    }
    // radius, softness, whether global
    Expression out = expressions_.node(Expression::Kind::call, syntax);
    const auto add = [&](const SyntaxExpression& place, double value, bool isLength) {
        Expression number = expressions_.node(Expression::Kind::number, place);
        number.number = value;
        number.isLength = isLength;
        out.children.push_back(std::move(number));
    };
    add(*radius, *um, true);
    add(soft ? *soft : syntax, *softUm, true);
    add(syntax, global ? 1.0 : 0.0, false);
    return out;
}

} // namespace patina
