// vdb-patina make SHAPE

#include "commands.h"
#include "console.h"
#include "model_input.h"
#include "outputs.h"

#include "surface/mesh_file.h"
#include "surface/shapes.h"

#include <fmt/format.h>

namespace patina::tool {

void addMakeCommand(CLI::App& app, Options& options, Action& action) {
    CLI::App* command = app.add_subcommand("make", "Models to try things on, as OBJ in metres, y up");
    auto shape = std::make_shared<std::string>();
    command->add_option("SHAPE", *shape, "plate, strip, sphere, groove, tower or statuette")->required();
    addGeneralOptions(*command, options);
    addOutputOption(*command, options);
    command->callback([&options, &action, shape] {
        action = [&options, shape](Console& console) {
            const Mesh mesh = makeUprightShape(*shape);
            const OutputFolder folder = outputFolder(options, ".");
            const auto file = folder.path() / (*shape + ".obj");
            writeObj(mesh, file);
            console.result(fmt::format("{}: {} faces", file.string(), mesh.faceCount()));
        };
    });
}

} // namespace patina::tool
