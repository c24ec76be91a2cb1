#include "picture_dice.h"

namespace patina::tool {

DiceOptions dicingOf(const View& view, const Options& options, double voxel) {
    DiceOptions dice;
    dice.pictureHeight = view.height;
    dice.pixelsPerEdge = float(options.dice);
    dice.longestEdge = 1.5f * float(voxel);
    dice.margin = float(voxel);
    return dice;
}

} // namespace patina::tool
