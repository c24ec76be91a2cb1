// all-rooms DATA: a script on a strip, its maps and its displaced surface, without the program.

#include "export/bake.h"
#include "render/displace.h"
#include "script/interpreter.h"
#include "surface/limit_surface.h"
#include "surface/shapes.h"
#include "volume/vdb_file.h"

#include <algorithm>
#include <cstdio>

int main(int count, char** words) {
    if (count != 2)
        return 2;
    patina::initializeVolumes();
    patina::Progress quiet;
    const auto materials = patina::MaterialLibrary::load(words[1]);
    patina::CheckContext context;
    patina::declareAbilities(context, materials);
    const auto program = patina::readProgram("new copper; coat tarnish_1 0.35;", "inline", context);
    const auto strip = patina::makeLimitSurface(patina::makeShape("strip"), {});
    const Imath::V3f size = strip.bounds().size();
    patina::RunOptions run;
    run.longestSide = std::max({size.x, size.y, size.z});
    run.scale.voxelSize = run.longestSide / 32.0;
    const auto result = patina::runProgram(program, strip, materials, run, quiet);

    const patina::StackOptics optics({&materials.at("copper"), &materials.at("tarnish_1")});
    patina::BakeOptions small;
    small.resolution = 32;
    const auto maps = patina::bake(*result.volume, strip, optics, small, quiet);
    const auto moved = patina::displaced(strip, std::vector<float>(strip.positions.size(), 1e-3f));
    std::printf("%zu statements, %zu maps, %zu vertices\n", result.finished, maps.maps.size(), moved.positions.size());
    return maps.find("displacement") && result.finished == program.statements.size() ? 0 : 1;
}
