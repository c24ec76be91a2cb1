#include "base/atomic_file.h"

#include "base/errors.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

namespace patina {

namespace fs = std::filesystem;

namespace {

fs::path temporaryName(const fs::path& final) {
    static std::atomic<unsigned> counter{0};
    const std::string name =
        fmt::format(".{}.{}-{}.part{}", final.stem().string(), ::getpid(), counter++, final.extension().string());
    return final.parent_path() / name;
}

} // namespace

AtomicFile::AtomicFile(fs::path final) : final_(std::move(final)), temporary_(temporaryName(final_)) {
    const fs::path folder = final_.has_parent_path() ? final_.parent_path() : fs::path(".");
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored))
        throw RunError(folder.string(), "the output folder does not exist", "make it, or give another with -o");
    std::ofstream probe(temporary_);
    if (!probe)
        throw RunError(folder.string(), fmt::format("cannot write here: {}", std::strerror(errno)),
                       "give a folder that can be written with -o");
}

AtomicFile::~AtomicFile() {
    std::error_code ignored;
    fs::remove(temporary_, ignored);
}

void AtomicFile::commit() {
    std::error_code failure;
    fs::rename(temporary_, final_, failure);
    if (failure)
        throw RunError(final_.string(), fmt::format("cannot write the file: {}", failure.message()));
}

OutputFolder::OutputFolder(fs::path folder) : folder_(std::move(folder)) {
    std::error_code failure;
    for (fs::path part = fs::absolute(folder_).lexically_normal();
         part != part.root_path() && !fs::exists(part, failure); part = part.parent_path())
        if (part.has_filename()) // not the empty name after a last slash
            made_.push_back(part);
    try {
        fs::create_directories(folder_, failure);
        if (failure || !fs::is_directory(folder_))
            throw RunError(
                folder_.string(),
                fmt::format("cannot make this folder: {}", failure ? failure.message() : "a file is in the way"),
                "give a folder that can be written with -o");
        AtomicFile probe(folder_ / "probe");
    } catch (...) {
        removeEmpty();
        throw;
    }
}

OutputFolder::~OutputFolder() {
    removeEmpty();
}

void OutputFolder::removeEmpty() {
    std::error_code ignored;
    for (const fs::path& part : made_)
        if (fs::is_directory(part, ignored) && !fs::remove(part, ignored))
            break; // something is in it
}

void writeTextFile(const fs::path& path, const std::string& text) {
    AtomicFile file(path);
    {
        std::ofstream out(file.temporary(), std::ios::binary);
        out << text;
        out.flush();
        if (!out)
            throw RunError(path.string(), fmt::format("cannot write the file: {}", std::strerror(errno)),
                           "is the disk full?");
    }
    file.commit();
}

std::string readTextFile(const fs::path& path) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored))
        throw RunError(path.string(), "is a folder, a file was expected");
    std::ifstream in(path, std::ios::binary);
    if (!in)
        throw RunError(path.string(), fmt::format("cannot read the file: {}", std::strerror(errno)), "check the name");
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

} // namespace patina
