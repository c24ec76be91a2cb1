// vdb-patina figure N: the paper's figures, made by this program

#include "command_line.h"
#include "commands.h"
#include "console.h"
#include "data_folder.h"
#include "figure_maker.h"
#include "figure_plan.h"
#include "outputs.h"

#include "base/errors.h"
#include "render/film.h"
#include "render/plate.h"

#include <fmt/format.h>

#include <algorithm>

namespace patina::tool {

namespace {

namespace fs = std::filesystem;

struct Arguments {
    int number = 0;
    std::string model;
    double scale = 1.0;
};

std::vector<PlacedImage> placed(const FigurePlan& plan, const std::vector<LabelledImage>& images) {
    std::vector<PlacedImage> out;
    for (std::size_t i = 0; i < images.size(); ++i) {
        const FigurePlace& place = *plan.panels[i].place; // without series, pictures are panels
        out.push_back({images[i], place.row, place.column, place.rows, place.columns});
    }
    return out;
}

void figure(const Arguments& arguments, const Options& options, Console& console) {
    const FigurePlan plan = readFigurePlan(findDataFolder(), arguments.number);
    const std::string name = fmt::format("figure_{:02}", arguments.number);
    const OutputFolder output = outputFolder(options, name);
    const fs::path& folder = output.path();
    FigureMaker maker(options, arguments.scale, folder, console);
    std::vector<LabelledImage> images;
    for (const FigureSeries& series : plan.series)
        for (LabelledImage& image : maker.series(series))
            images.push_back(std::move(image));
    for (const FigurePanel& panel : plan.panels)
        images.push_back(maker.panel(panel, arguments.model));
    ContactSheetOptions sheetOptions;
    sheetOptions.title = plan.title;
    sheetOptions.columns = plan.columns;
    const ContactSheet sheet =
        plan.isPlaced() ? makePlate(placed(plan, images), sheetOptions) : makeContactSheet(images, sheetOptions);
    if (!sheet.hasText)
        console.warning("no font was found on this machine: the figure has no labels");
    const fs::path file = folder / (name + ".png");
    writePng(sheet.image, file, {{"Software", "vdb-patina " PATINA_VERSION}, {"Description", plan.title}});
    console.result(file.string());
}

} // namespace

void addFigureCommand(CLI::App& app, Options& options, Action& action) {
    CLI::App* command = app.add_subcommand("figure", "Figures of Dorsey and Hanrahan 1996, made by this program");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("NUMBER", arguments->number, "Of the figure in the paper")->required();
    command->add_option("--model", arguments->model, "Another model, where the figure shows one object")
        ->type_name("FILE")
        ->group("Figure");
    command
        ->add_option("--scale", arguments->scale,
                     "Of all pictures' sides; voxels go with it, samples with its square (default 1; 0.25: a draft)")
        ->check(numberWithin(0.05, 8.0))
        ->type_name("X")
        ->group("Figure");
    addGeneralOptions(*command, options);
    addOutputOption(*command, options);
    command->callback([&options, &action, arguments] {
        action = [&options, arguments](Console& console) { figure(*arguments, options, console); };
    });
}

} // namespace patina::tool
