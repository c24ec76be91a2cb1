#pragma once
// Where the program's materials, spectra and scripts lie.

#include <filesystem>

namespace patina::tool {

/// $VDB_PATINA_DATA, or beside the installed program (../share/vdb-patina), or the `data` folder of the source tree
/// that the program was built in. \throws RunError naming what was looked at
std::filesystem::path findDataFolder();

} // namespace patina::tool
