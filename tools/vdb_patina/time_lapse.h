#pragma once
// The pictures between the frames of a history, and the film of all of them.

#include "console.h"
#include "options.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patina::tool {

struct TimeLapse {
    std::string model;                          ///< as on the command line
    std::string name;                           ///< of the pictures (NAME_0001.png …) and the film (NAME.mp4)
    std::vector<std::filesystem::path> volumes; ///< of the frames, in order
    int between = 0;                            ///< pictures between one frame and the next
    double framesPerSecond = 12.0;
};

/// The number in the sequence of a frame's own picture, from 1.
int numberOfFrame(std::size_t frame, int between);

/// "NAME_0001.png" in the folder.
std::filesystem::path pictureNumbered(const std::filesystem::path& folder, const std::string& name, int number);

/// Renders what lies between the frames, whose own pictures stand in the folder already, and encodes the film where
/// ffmpeg is installed; says so where it is not. options.view must be set.
void writeTimeLapse(const TimeLapse& lapse, const Options& options, const std::filesystem::path& folder,
                    Console& console);

} // namespace patina::tool
