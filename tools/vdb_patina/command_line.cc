#include "command_line.h"

#include "base/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

namespace patina::tool {

namespace {

class HelpLayout : public CLI::Formatter {
  public:
    HelpLayout() {
        column_width(30);
        label("Positionals", "Arguments");
        label("OPTIONS", "options");
        label("SUBCOMMAND", "COMMAND …");
    }

    // What it takes, and nothing of the checks behind it.
    std::string make_option_opts(const CLI::Option* option) const override {
        if (option->get_positional() || option->get_type_size() == 0 || option->get_type_name().empty())
            return {};
        return " " + option->get_type_name();
    }

    std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
        std::string text = Formatter::make_help(app, name, mode);
        for (std::size_t at; (at = text.find("\n\n\n")) != std::string::npos;)
            text.erase(at, 1);
        while (text.size() > 1 && text[text.size() - 2] == '\n')
            text.pop_back();
        return text;
    }

    std::string make_description(const CLI::App* app) const override { return app->get_description() + "\n\n"; }
};

std::optional<double> numberIn(const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !std::isfinite(value))
        return std::nullopt;
    return value;
}

std::string listed(const std::vector<std::string>& words) {
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i)
        text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
    return text;
}

std::string inBrackets(const std::string& hint) {
    return hint.empty() ? hint : " (" + hint + ")";
}

std::vector<std::string> commandNames(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(command->get_name());
    return names;
}

std::string describeMissingCommand(const CLI::App& app, const std::vector<std::string>& words) {
    const auto names = commandNames(app);
    const auto word =
        std::find_if(words.begin(), words.end(), [](const std::string& w) { return w.rfind("-", 0) != 0; });
    if (word == words.end())
        return "a command is missing: one of " + listed(names);
    const std::string extension = ".patina";
    if (word->size() > extension.size() &&
        word->compare(word->size() - extension.size(), extension.size(), extension) == 0)
        return fmt::format("'{}' is not a command (did you mean 'vdb-patina run {}'?)", *word, *word);
    const std::string hint = didYouMean(*word, names);
    return fmt::format("'{}' is not a command ({})", *word, hint.empty() ? "one of " + listed(names) : hint);
}

std::string describeUnexpected(const CLI::App& app) {
    const auto chosen = app.get_subcommands();
    const CLI::App& command = chosen.empty() ? app : *chosen.front();
    std::vector<std::string> left = command.remaining();
    const bool before = chosen.empty() || left.empty();
    if (left.empty())
        left = app.remaining(true);
    if (left.empty())
        return "an argument was not expected";
    const std::string word = left.front().substr(0, left.front().find('='));
    if (word.rfind("-", 0) != 0)
        return fmt::format("'{}' is one argument too many", word);
    std::vector<std::string> known;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames())
            known.push_back("--" + name);
    if (before)
        return fmt::format("option '{}' stands before the command (write it behind)", word);
    return fmt::format("'{}' has no option '{}'{}", command.get_name(), word, inBrackets(didYouMean(word, known)));
}

} // namespace

std::shared_ptr<CLI::FormatterBase> helpLayout() {
    return std::make_shared<HelpLayout>();
}

CLI::Validator numberWithin(double lowest, double highest) {
    return CLI::Validator(
        [lowest, highest](std::string& text) {
            const auto value = numberIn(text);
            return value && *value >= lowest && *value <= highest
                       ? std::string()
                       : fmt::format("'{}' is not a number from {:g} to {:g}", text, lowest, highest);
        },
        "");
}

CLI::Validator wholeNumberWithin(long long lowest, long long highest) {
    return CLI::Validator(
        [lowest, highest](std::string& text) {
            const bool whole =
                !text.empty() && text.find_first_not_of("0123456789", text[0] == '-' ? 1 : 0) == std::string::npos;
            const auto value = numberIn(text);
            return whole && value && *value >= double(lowest) && *value <= double(highest)
                       ? std::string()
                       : fmt::format("'{}' is not a whole number from {} to {}", text, lowest, highest);
        },
        "");
}

CLI::Validator numberAboveZero() {
    return CLI::Validator(
        [](std::string& text) {
            const auto value = numberIn(text);
            return value && *value > 0.0 ? std::string() : fmt::format("'{}' is not a number above 0", text);
        },
        "");
}

CLI::Validator oneOf(std::vector<std::string> words) {
    return CLI::Validator(
        [words = std::move(words)](std::string& text) {
            if (std::find(words.begin(), words.end(), text) != words.end())
                return std::string();
            const std::string hint = didYouMean(text, words);
            return fmt::format("'{}' is not {}{}", text, listed(words), inBrackets(hint));
        },
        "");
}

std::string describeParseError(const CLI::ParseError& error, const CLI::App& app,
                               const std::vector<std::string>& words) {
    if (dynamic_cast<const CLI::ExtrasError*>(&error))
        return describeUnexpected(app);
    if (dynamic_cast<const CLI::RequiredError*>(&error)) {
        const auto chosen = app.get_subcommands();
        if (chosen.empty())
            return describeMissingCommand(app, words);
        return error.what();
    }
    if (dynamic_cast<const CLI::ConversionError*>(&error)) {
        // "Could not convert: --at = a,b,c"
        const std::string text = error.what();
        const std::size_t colon = text.find(": "), equals = text.find(" = ");
        if (colon != std::string::npos && equals != std::string::npos && equals > colon)
            return fmt::format("{}: '{}' is not a number it can take", text.substr(colon + 2, equals - colon - 2),
                               text.substr(equals + 3));
        return text;
    }
    if (dynamic_cast<const CLI::ExcludesError*>(&error)) {
        std::string text = error.what();
        const std::size_t at = text.find(" excludes ");
        if (at != std::string::npos)
            return fmt::format("{} and {} exclude each other (leave one out)", text.substr(0, at),
                               text.substr(at + 10));
        return text;
    }
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) {
        // "--samples: 1 required N missing", "--samples: At Most 1 required but received 2"
        const std::string text = error.what(), received = "At Most 1 required but received ";
        const std::size_t colon = text.find(": "), times = text.find(received);
        if (colon != std::string::npos && times != std::string::npos)
            return fmt::format("{} is given {} times", text.substr(0, colon), text.substr(times + received.size()));
        if (colon != std::string::npos && text.find(" missing") != std::string::npos)
            return text.substr(0, colon) + ": its value is missing";
        return text;
    }
    return error.what();
}

std::string whereHelpIs(const CLI::App& app) {
    const auto chosen = app.get_subcommands();
    return fmt::format("vdb-patina {}--help tells more.", chosen.empty() ? "" : chosen.front()->get_name() + " ");
}

} // namespace patina::tool
