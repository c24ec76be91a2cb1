#pragma once
// All the materials that scripts may name.

#include "optics/material.h"

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace patina {

/// Materials by name. Loaded once, read from any thread; pointers stay valid as long as the library lives.
class MaterialLibrary {
  public:
    /// Reads every `materials/*.toml` of a data folder, and the spectra they name (relative to the data folder).
    /// \throws ScriptError with all findings, each with file, line and column: unknown key or unit, a spectrum out of
    ///         order or with gaps, a reflectance outside 0…1, a mixture that contains itself or an unknown material,
    ///         a missing spectrum.
    /// \throws RunError when the folder cannot be read.
    static MaterialLibrary load(const std::filesystem::path& dataFolder);

    /// nullptr for an unknown name.
    const Material* find(std::string_view name) const;
    /// \throws RunError naming the nearest material for an unknown one.
    const Material& at(std::string_view name) const;
    /// Sorted.
    std::vector<std::string> names() const;
    std::size_t size() const { return materials_.size(); }

  private:
    std::map<std::string, Material, std::less<>> materials_;
};

} // namespace patina
