#pragma once
// One `data/materials/NAME.toml`, read but not yet resolved: mixtures still name their parts. docs/optics.md lists the
// keys.

#include "base/errors.h"
#include "optics/material.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace patina {

/// A part of a mixture and where it was named.
struct MixturePart {
    std::string material;
    double volume = 0.0;
    SourcePlace place;
};

/// What a material file says. Of `reflectance`, `ratio` and `absorption` at most one is set, none in a mixture.
struct MaterialDescription {
    Material material; ///< name, title, source, surface and solid; spectra still empty
    std::filesystem::path path;
    SourcePlace place;

    std::optional<FineSpectrum> reflectance; ///< metals: normal incidence. Films: opaque, without the air interface
    std::optional<FineSpectrum> ratio;       ///< K/S
    std::optional<FineSpectrum> absorption;  ///< K, 1/µm
    std::optional<FineSpectrum> scattering;  ///< S, 1/µm
    std::optional<FineSpectrum> indexN;      ///< n of the solid: metals with [index], films with [refraction]
    std::optional<FineSpectrum> indexK;      ///< k, metals only
    double hidesAtUm = 0.0;                  ///< > 0: S follows from the thickness that hides what is below

    std::vector<MixturePart> parts;
    double scatteringFactor = 1.0; ///< mixtures: how much better than its parts it scatters
};

/// Reads one file. Findings are appended; with any error among them the description is not to be used.
MaterialDescription readMaterialFile(const std::filesystem::path& path, const std::filesystem::path& dataFolder,
                                     std::vector<Diagnostic>& findings);

} // namespace patina
