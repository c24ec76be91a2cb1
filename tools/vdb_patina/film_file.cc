#include "film_file.h"

#include "base/atomic_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <vector>

namespace patina::tool {

namespace {

std::vector<std::string> wordsOf(const FilmFile& film, const std::filesystem::path& file) {
    return {"ffmpeg", "-nostdin", "-y", "-loglevel", "error", "-framerate", fmt::format("{:g}", film.framesPerSecond),
            "-start_number", "1", "-i", film.pictures,
            // Pictures of an earlier, longer series may stand in the same folder.
            "-frames:v", std::to_string(film.count), "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-c:v", "libx264", "-crf",
            "16", "-pix_fmt", "yuv420p", "-movflags", "+faststart", file.string()};
}

} // namespace

FilmResult encodeFilm(const FilmFile& film, const std::filesystem::path& file) {
    AtomicFile whole(file);
    std::vector<std::string> words = wordsOf(film, whole.temporary());
    std::vector<char*> arguments;
    for (std::string& word : words)
        arguments.push_back(word.data());
    arguments.push_back(nullptr);
    // Results alone go to stdout.
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
    pid_t child = 0;
    const int started = posix_spawnp(&child, "ffmpeg", &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (started != 0)
        return FilmResult::noProgram;
    int status = 0;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return FilmResult::failed;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || !std::filesystem::exists(whole.temporary()))
        return FilmResult::failed;
    whole.commit();
    return FilmResult::done;
}

std::string filmCommand(const FilmFile& film, const std::filesystem::path& file) {
    std::vector<std::string> words = wordsOf(film, file);
    for (std::string& word : words)
        if (word.find_first_of(" ()*'\"") != std::string::npos)
            word = '"' + word + '"';
    return fmt::format("{}", fmt::join(words, " "));
}

} // namespace patina::tool
