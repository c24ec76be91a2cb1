#pragma once
// A film from numbered pictures, by the ffmpeg that is installed on the machine.

#include <filesystem>
#include <string>

namespace patina::tool {

struct FilmFile {
    std::string pictures; ///< path with "%04d" for the number, from 1
    int count = 0;
    double framesPerSecond = 12.0;
};

enum class FilmResult { done, noProgram, failed };

/// H.264 in 4:2:0, which every player reads; odd sides get a row or column more. What ffmpeg complains of goes to
/// stderr. The film appears under its name when it is whole.
/// \throws RunError where the folder cannot be written
FilmResult encodeFilm(const FilmFile& film, const std::filesystem::path& file);

/// The same for a shell.
std::string filmCommand(const FilmFile& film, const std::filesystem::path& file);

} // namespace patina::tool
