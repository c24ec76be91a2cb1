// texture("file.png", channel) and texture(growth); files that a script names.

#include "script/expression_checker.h"
#include "script/vocabulary.h"

#include <fmt/format.h>

#include <filesystem>

namespace patina {

using Kind = Expression::Kind;
using SyntaxKind = SyntaxExpression::Kind;

std::optional<std::string> ExpressionChecker::file(const std::string& name, std::size_t offset,
                                                   const std::string& what) {
    if (name.empty()) {
        findings_.error(offset, fmt::format("the name of {} is empty", what));
        return std::nullopt;
    }
    std::filesystem::path folder = context_.baseFolder;
    if (folder.empty())
        folder = std::filesystem::path(findings_.source().file()).parent_path();
    const std::filesystem::path path = folder / name;
    std::error_code failure;
    if (context_.checkFiles && !std::filesystem::is_regular_file(path, failure)) {
        findings_.error(offset, fmt::format("{} '{}' does not exist", what, name),
                        fmt::format("looked for {}", path.string()));
        return std::nullopt;
    }
    return path.string();
}

std::optional<Expression> ExpressionChecker::texture(const SyntaxExpression& syntax) {
    const SyntaxExpression& first = syntax.children[0];
    if (GrowthChecker::looksLikeGrowth(first)) {
        if (syntax.children.size() > 1) {
            findings_.error(syntax.children[1].offset, "texture of a growth pattern has one argument");
            return std::nullopt;
        }
        std::optional<GrowthCall> growth = GrowthChecker(*this).resolve(first);
        if (!growth)
            return std::nullopt;
        growth->ofFull = first.ofFull || syntax.ofFull || growth->since > 0;
        Expression out = node(Kind::growth, syntax);
        out.growth = std::make_shared<const GrowthCall>(std::move(*growth));
        return out;
    }
    if (syntax.ofFull) {
        findings_.error(syntax.ofOffset, "'of full' belongs behind a growth pattern",
                        "texture(BD.linear_1.20) of full");
        return std::nullopt;
    }
    if (first.kind != SyntaxKind::string) {
        if (first.kind == SyntaxKind::name && vocabulary::contains(vocabulary::growthModels(), first.text))
            return name(first);
        findings_.error(first.offset, "texture needs an image file in quotes or a growth pattern",
                        fmt::format("it is written {}", vocabulary::signature("texture")->usage));
        return std::nullopt;
    }
    const std::optional<std::string> path = file(first.text, first.offset, "the texture");
    if (!path)
        return std::nullopt;
    const ImageChannels* image = nullptr;
    if (context_.checkFiles) {
        image = &images_.try_emplace(*path, *path).first->second;
        if (!image->failure().empty()) {
            findings_.error(first.offset, fmt::format("the texture '{}' cannot be read as an image", first.text),
                            image->failure());
            return std::nullopt;
        }
    }
    Expression out = node(Kind::call, syntax);
    out.children.push_back(node(Kind::string, first));
    out.children.back().text = *path;
    if (syntax.children.size() < 2)
        return out;
    const SyntaxExpression& channel = syntax.children[1];
    std::string asked = channel.text;
    if (channel.kind == SyntaxKind::name || channel.kind == SyntaxKind::string) {
        out.children.push_back(node(Kind::name, channel));
    } else {
        const auto number = wholeNumber(channel, "the channel (a name such as R, or a number from 0)", 0, 1000);
        if (!number)
            return std::nullopt;
        out.children.push_back(node(Kind::number, channel));
        out.children.back().number = *number;
        asked = fmt::format("{}", static_cast<int>(*number));
    }
    if (image && !image->find(asked)) {
        findings_.error(channel.offset, fmt::format("the texture '{}' has no channel '{}'", first.text, asked),
                        fmt::format("it has {}", vocabulary::listed(image->names())));
        return std::nullopt;
    }
    return out;
}

} // namespace patina
