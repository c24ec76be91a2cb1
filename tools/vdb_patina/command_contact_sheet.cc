// vdb-patina contact-sheet PNG... -o FILE

#include "command_line.h"
#include "commands.h"
#include "console.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "render/contact_sheet.h"
#include "render/film.h"

#include <fmt/format.h>

namespace patina::tool {

namespace {

struct Arguments {
    std::vector<std::string> pictures;
    std::vector<std::string> labels;
    std::string title;
    std::string file = "contact_sheet.png";
    int columns = 0;
};

void makeSheet(const Arguments& arguments, Console& console) {
    if (!arguments.labels.empty() && arguments.labels.size() != arguments.pictures.size())
        throw Error(ExitCode::commandLine, "--label",
                    fmt::format("{} labels for {} pictures", arguments.labels.size(), arguments.pictures.size()),
                    "give one label for each picture, in their order");
    std::vector<LabelledImage> images;
    for (std::size_t i = 0; i < arguments.pictures.size(); ++i)
        images.push_back({asRgb(readPng(arguments.pictures[i])), arguments.labels.empty() ? "" : arguments.labels[i]});
    ContactSheetOptions options;
    options.columns = arguments.columns;
    options.title = arguments.title;
    const ContactSheet sheet = makeContactSheet(images, options);
    if (!sheet.hasText)
        console.warning("no font was found on this machine: the sheet has no labels");
    writePng(sheet.image, arguments.file, {{"Software", "vdb-patina " PATINA_VERSION}});
    console.result(arguments.file);
}

} // namespace

void addContactSheetCommand(CLI::App& app, Options& options, Action& action) {
    CLI::App* command = app.add_subcommand("contact-sheet", "Several pictures on one sheet, with labels");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("PICTURES", arguments->pictures, "PNG files")->required();
    command->add_option("--label", arguments->labels, "Label of each picture, in order")
        ->allow_extra_args(false)
        ->type_name("TEXT")
        ->group("Sheet");
    command->add_option("--title", arguments->title, "Above all of them")->type_name("TEXT")->group("Sheet");
    command->add_option("--columns", arguments->columns, "Pictures in a row (default: about 16:9)")
        ->check(wholeNumberWithin(1, 100))
        ->type_name("N")
        ->group("Sheet");
    command->add_option("-o,--output", arguments->file, "The sheet (default contact_sheet.png)")
        ->type_name("FILE")
        ->group("Sheet");
    addGeneralOptions(*command, options);
    command->callback(
        [&action, arguments] { action = [arguments](Console& console) { makeSheet(*arguments, console); }; });
}

} // namespace patina::tool
