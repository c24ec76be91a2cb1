#include "optics/material_library.h"

#include "base/errors.h"
#include "base/names.h"
#include "optics/colour.h"
#include "optics/fresnel.h"
#include "optics/kubelka_munk.h"
#include "optics/material_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace patina {

namespace {

using Imath::V3d;
using Imath::V3f;

constexpr double pi = 3.14159265358979323846;
/// Parts of known index must make up this much of a mixture that interferes; the rest is taken to be like them.
constexpr double leastKnownVolume = 0.8;
/// Over black it must look this bright relative to over white to hide what is below (contrast ratio, ISO 6504).
constexpr double hidingContrast = 0.98;

V3f clippedColour(const FineSpectrum& reflectance) {
    const V3d rgb = linearRec709(reflectance);
    return {static_cast<float>(std::clamp(rgb.x, 0.0, 1.0)), static_cast<float>(std::clamp(rgb.y, 0.0, 1.0)),
            static_cast<float>(std::clamp(rgb.z, 0.0, 1.0))};
}

/// S such that a layer of this thickness reaches the hiding contrast. The contrast rises with S at fixed K/S.
double scatteringThatHides(const FineSpectrum& ratio, double thicknessUm) {
    const auto contrast = [&](double scattering) {
        FineSpectrum overBlack{};
        FineSpectrum overWhite{};
        for (int i = 0; i < fineCount; ++i) {
            const auto layer = kubelkaMunkLayer(ratio[i] * scattering, scattering, thicknessUm);
            overBlack[i] = layer.reflectance;
            overWhite[i] = overBackground(layer, 1.0);
        }
        return xyzFromReflectance(overBlack).y / xyzFromReflectance(overWhite).y;
    };
    double low = 1e-6 / thicknessUm;
    double high = 1e6 / thicknessUm;
    for (int step = 0; step < 80; ++step) {
        const double middle = std::sqrt(low * high);
        (contrast(middle) < hidingContrast ? low : high) = middle;
    }
    return std::sqrt(low * high);
}

/// K and S of a film that is no mixture.
void resolveFilm(const MaterialDescription& description, Material& material) {
    FineSpectrum ratio{};
    if (description.reflectance || description.ratio) {
        for (int i = 0; i < fineCount; ++i) {
            ratio[i] =
                description.ratio ? (*description.ratio)[i] : absorptionOverScattering((*description.reflectance)[i]);
        }
    }
    if (description.hidesAtUm > 0.0) {
        material.fineScattering.fill(scatteringThatHides(ratio, description.hidesAtUm));
    } else {
        material.fineScattering = *description.scattering;
    }
    for (int i = 0; i < fineCount; ++i) {
        material.fineAbsorption[i] =
            description.absorption ? (*description.absorption)[i] : ratio[i] * material.fineScattering[i];
    }
}

/// n as given, k as the metal's file has it or from the film's K = 2 · 4 pi k / lambda.
void setIndex(const MaterialDescription& description, Material& material) {
    if (!description.indexN) {
        return;
    }
    material.hasIndex = true;
    material.fineN = *description.indexN;
    if (description.indexK) {
        material.fineK = *description.indexK;
    }
}

/// Everything that follows from K and S, or from a metal's reflectance.
void finish(Material& material) {
    FineSpectrum inAir{};
    if (material.isMetal) {
        inAir = material.fineReflectance;
        material.specularColour = clippedColour(material.fineReflectance);
    } else {
        const double k1 = normalReflectance(material.refractiveIndex, 0.0);
        const double k2 = diffuseInterface(material.refractiveIndex).internal;
        for (int i = 0; i < fineCount; ++i) {
            material.fineReflectance[i] = infiniteReflectance(material.fineAbsorption[i], material.fineScattering[i]);
            inAir[i] = saunderson(material.fineReflectance[i], k1, k2);
        }
        material.specularColour = V3f(static_cast<float>(k1));
    }
    if (material.hasIndex) {
        for (int i = 0; i < fineCount && !material.isMetal; ++i) {
            material.fineK[i] = material.fineAbsorption[i] * fineWavelengthNm(i) * 1e-3 / (8.0 * pi);
        }
        material.indexN = atBands(material.fineN);
        material.indexK = atBands(material.fineK);
    }
    material.absorption = atBands(material.fineAbsorption);
    material.scattering = atBands(material.fineScattering);
    material.reflectance = atBands(material.fineReflectance);
    material.swatch = clippedColour(inAir);
}

/// Resolves descriptions to materials, parts before the mixtures that name them.
class Resolver {
  public:
    Resolver(const std::map<std::string, MaterialDescription, std::less<>>& descriptions,
             std::vector<Diagnostic>& findings)
        : descriptions_(descriptions), findings_(findings) {
        for (const auto& [name, description] : descriptions) {
            names_.push_back(name);
        }
    }

    const Material* resolve(const std::string& name) {
        if (const auto found = done_.find(name); found != done_.end()) {
            return &found->second;
        }
        const MaterialDescription& description = descriptions_.at(name);
        Material material = description.material;
        if (material.isMetal) {
            material.fineReflectance = *description.reflectance;
        } else if (description.parts.empty()) {
            resolveFilm(description, material);
        } else if (!resolveMixture(description, material)) {
            return nullptr;
        }
        setIndex(description, material);
        finish(material);
        return &done_.emplace(name, std::move(material)).first->second;
    }

    std::map<std::string, Material, std::less<>> take() { return std::move(done_); }

  private:
    // Duncan 1940: K and S of a mixture are the sums of its parts', each by its share of the volume.
    bool resolveMixture(const MaterialDescription& description, Material& material) {
        const std::string& name = description.material.name;
        if (failed_.count(name) > 0) {
            return false;
        }
        open_.insert(name);
        bool good = true;
        double knownVolume = 0.0;
        double solidKgPerM3 = 0.0;
        bool densityKnown = true;
        FineSpectrum sumN{};
        for (const MixturePart& part : description.parts) {
            const Material* resolved = nullptr;
            if (open_.count(part.material) > 0) {
                report(part, part.material == name
                                 ? fmt::format("mixture '{}' names itself", name)
                                 : fmt::format("mixture '{}' contains '{}', which contains it", name, part.material));
            } else if (descriptions_.find(part.material) == descriptions_.end()) {
                report(part, fmt::format("unknown material '{}'", part.material), didYouMean(part.material, names_));
            } else if (descriptions_.at(part.material).material.isMetal) {
                report(part, fmt::format("'{}' is a metal and cannot be part of a mixture", part.material));
            } else {
                resolved = resolve(part.material);
            }
            if (!resolved) {
                good = false;
                continue;
            }
            knownVolume += resolved->hasIndex ? part.volume : 0.0;
            solidKgPerM3 += part.volume * resolved->densityKgPerM3;
            densityKnown = densityKnown && resolved->densityKgPerM3 > 0.f;
            for (int i = 0; i < fineCount; ++i) {
                sumN[i] += resolved->hasIndex ? part.volume * resolved->fineN[i] : 0.0;
                material.fineAbsorption[i] += part.volume * resolved->fineAbsorption[i];
                material.fineScattering[i] += part.volume * resolved->fineScattering[i] * description.scatteringFactor;
            }
        }
        open_.erase(name);
        if (material.densityKgPerM3 == 0.f && densityKnown) {
            material.densityKgPerM3 = static_cast<float>(solidKgPerM3);
        }
        if (knownVolume >= leastKnownVolume) {
            material.hasIndex = true;
            for (int i = 0; i < fineCount; ++i) {
                material.fineN[i] = sumN[i] / knownVolume;
            }
        }
        if (!good) {
            failed_.insert(name);
        }
        return good;
    }

    void report(const MixturePart& part, std::string message, std::string remedy = {}) {
        Diagnostic finding;
        finding.place = part.place;
        finding.message = std::move(message);
        finding.remedy = std::move(remedy);
        findings_.push_back(finding);
    }

    const std::map<std::string, MaterialDescription, std::less<>>& descriptions_;
    std::vector<Diagnostic>& findings_;
    std::vector<std::string> names_;
    std::set<std::string> open_;
    std::set<std::string> failed_;
    std::map<std::string, Material, std::less<>> done_;
};

} // namespace

MaterialLibrary MaterialLibrary::load(const std::filesystem::path& dataFolder) {
    const std::filesystem::path folder = dataFolder / "materials";
    std::error_code error;
    std::vector<std::filesystem::path> paths;
    for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        if (entry->path().extension() == ".toml") {
            paths.push_back(entry->path());
        }
    }
    if (error) {
        throw RunError(folder.string(), "the folder of materials cannot be read: " + error.message(),
                       "give the program's data folder");
    }
    std::sort(paths.begin(), paths.end());

    std::vector<Diagnostic> findings;
    std::map<std::string, MaterialDescription, std::less<>> descriptions;
    for (const auto& path : paths) {
        MaterialDescription description = readMaterialFile(path, dataFolder, findings);
        std::string name = description.material.name;
        descriptions.emplace(std::move(name), std::move(description));
    }
    // A file with an error has no optics to resolve, so its mixtures cannot be checked yet.
    if (!findings.empty()) {
        throw ScriptError(findings);
    }
    Resolver resolver(descriptions, findings);
    for (const auto& [name, description] : descriptions) {
        resolver.resolve(name);
    }
    if (!findings.empty()) {
        throw ScriptError(findings);
    }
    MaterialLibrary library;
    library.materials_ = resolver.take();
    return library;
}

const Material* MaterialLibrary::find(std::string_view name) const {
    const auto found = materials_.find(name);
    return found == materials_.end() ? nullptr : &found->second;
}

const Material& MaterialLibrary::at(std::string_view name) const {
    if (const Material* material = find(name)) {
        return *material;
    }
    throw RunError("materials", fmt::format("unknown material '{}'", name), didYouMean(name, names()));
}

std::vector<std::string> MaterialLibrary::names() const {
    std::vector<std::string> result;
    for (const auto& [name, material] : materials_) {
        result.push_back(name);
    }
    return result;
}

} // namespace patina
