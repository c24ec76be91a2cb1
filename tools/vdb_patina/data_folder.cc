#include "data_folder.h"

#include "base/errors.h"

#include <cstdlib>

namespace patina::tool {

namespace fs = std::filesystem;

fs::path findDataFolder() {
    std::error_code ignored;
    const auto holdsData = [&](const fs::path& folder) { return fs::is_directory(folder / "materials", ignored); };
    if (const char* given = std::getenv("VDB_PATINA_DATA")) {
        if (!holdsData(given))
            throw RunError(given, "has no folder 'materials'", "VDB_PATINA_DATA must name the program's data folder");
        return given;
    }
    const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
    fs::path folder = program.parent_path();
    if (holdsData(folder / "../share/vdb-patina"))
        return fs::weakly_canonical(folder / "../share/vdb-patina", ignored);
    for (; folder.has_relative_path(); folder = folder.parent_path())
        if (holdsData(folder / "data"))
            return folder / "data";
    throw RunError(program.string(), "cannot find the program's data folder", "set VDB_PATINA_DATA to it");
}

} // namespace patina::tool
