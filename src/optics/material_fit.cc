#include "optics/material_fit.h"

#include "base/errors.h"
#include "optics/fresnel.h"
#include "optics/kubelka_munk.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

[[noreturn]] void refuse(const MeasuredLayer& layer, double wavelengthNm, const std::string& message,
                         const std::string& remedy) {
    throw Error(ExitCode::script, layer.name, fmt::format("at {:g} nm: {}", wavelengthNm, message), remedy);
}

double backingAt(const MeasuredLayer& layer, double wavelengthNm) {
    return layer.backing.values.empty() ? 0.0 : layer.backing.at(wavelengthNm);
}

/// a = 1 + K / S and c = b coth(b S d), where b = sqrt(a² - 1), as the coefficients of a layer of thickness d.
void addSample(FittedCoefficients& fitted, const MeasuredLayer& layer, double wavelengthNm, double a, double c) {
    // What rounding to four digits takes from a layer that absorbs nothing.
    if (a < 1.0 && a > 1.0 - 1e-3)
        a = 1.0;
    if (!(a >= 1.0))
        refuse(layer, wavelengthNm, "no layer has these reflectances: it would return more than it receives",
               "check the calibration, and whether the spectra are without the reflection of the sample's own surface "
               "(--body) or not");
    const double b = std::sqrt(a * a - 1.0);
    if (!(c > b) || !std::isfinite(c))
        refuse(layer, wavelengthNm, "the layer hides what is below: its thickness cannot be told",
               "measure a thinner one, or fit the opaque sample with an assumed scattering");
    const double scattering = b > 1e-7 * c ? std::log((c + b) / (c - b)) / (2.0 * b) : 1.0 / c;
    for (TabulatedSpectrum* spectrum : {&fitted.absorption, &fitted.scattering})
        spectrum->wavelengthsNm.push_back(wavelengthNm);
    fitted.absorption.values.push_back((a - 1.0) * scattering / layer.thicknessUm);
    fitted.scattering.values.push_back(scattering / layer.thicknessUm);
}

void checkThickness(const MeasuredLayer& layer) {
    if (!(layer.thicknessUm > 0.0) || std::isinf(layer.thicknessUm))
        throw Error(ExitCode::script, layer.name, "the thickness of this sample must be known",
                    "give it in micrometres: --thickness 5");
}

double opaqueAt(const MeasuredLayer& opaque, double wavelengthNm) {
    const double r = opaque.reflectance.at(wavelengthNm);
    if (!(r > 0.0 && r < 1.0))
        refuse(opaque, wavelengthNm, fmt::format("an opaque sample reflects {:g}", r),
               "expected more than 0 and less than 1");
    return r;
}

std::string listed(const std::vector<double>& numbers) {
    std::string text;
    for (std::size_t i = 0; i < numbers.size(); ++i)
        text += fmt::format("{}{:.7g},", i % 8 == 0 ? "\n    " : " ", numbers[i]);
    return text + "\n";
}

/// TOML's basic strings.
std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            out += '\\';
        out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return out + "\"";
}

} // namespace

FittedCoefficients fitOpaque(const MeasuredLayer& opaque, double scatteringPerUm) {
    if (!(scatteringPerUm > 0.0) || std::isinf(scatteringPerUm))
        throw Error(ExitCode::script, opaque.name, "an opaque sample gives K only for a known scattering",
                    "assume one above 0, in 1/µm: --scattering 0.25");
    FittedCoefficients fitted;
    for (const double nm : opaque.reflectance.wavelengthsNm) {
        fitted.absorption.wavelengthsNm.push_back(nm);
        fitted.scattering.wavelengthsNm.push_back(nm);
        fitted.absorption.values.push_back(scatteringPerUm * absorptionOverScattering(opaqueAt(opaque, nm)));
        fitted.scattering.values.push_back(scatteringPerUm);
    }
    return fitted;
}

FittedCoefficients fitOpaqueAndThin(const MeasuredLayer& opaque, const MeasuredLayer& thin) {
    checkThickness(thin);
    FittedCoefficients fitted;
    for (const double nm : thin.reflectance.wavelengthsNm) {
        const double infinite = opaqueAt(opaque, nm), r = thin.reflectance.at(nm), g = backingAt(thin, nm);
        if (std::abs(r - g) < 1e-6)
            refuse(thin, nm, fmt::format("it is as bright as its backing, {:g}: it may as well not be there", r),
                   "measure it over another backing, or a thicker one");
        const double a = 0.5 * (infinite + 1.0 / infinite);
        addSample(fitted, thin, nm, a, (1.0 + g * r - a * (r + g)) / (r - g));
    }
    return fitted;
}

FittedCoefficients fitTwoBackings(const MeasuredLayer& first, const MeasuredLayer& second) {
    checkThickness(first);
    FittedCoefficients fitted;
    for (const double nm : first.reflectance.wavelengthsNm) {
        const double r = first.reflectance.at(nm), s = second.reflectance.at(nm);
        const double g = backingAt(first, nm), h = backingAt(second, nm);
        if (std::abs(g - h) < 1e-3)
            refuse(second, nm, fmt::format("the two backings are too alike, {:g} and {:g}", g, h),
                   "black and white ones tell most");
        if (std::abs(r - s) < 1e-7)
            refuse(second, nm, "the layer looks the same over both backings: it hides them",
                   "measure a thinner one, or fit the opaque sample with an assumed scattering");
        const double determinant = 2.0 * (g * s - r * h);
        const double p = 1.0 + g * r, q = 1.0 + h * s;
        addSample(fitted, first, nm, (p * (s - h) - q * (r - g)) / determinant,
                  (q * (r + g) - p * (s + h)) / determinant);
    }
    return fitted;
}

TabulatedSpectrum bodyReflectance(const TabulatedSpectrum& inAir, double refractiveIndex) {
    const double k1 = normalReflectance(refractiveIndex, 0.0), k2 = diffuseInterface(refractiveIndex).internal;
    TabulatedSpectrum body = inAir;
    for (double& value : body.values)
        value = std::max(0.0, inverseSaunderson(value, k1, k2));
    return body;
}

std::string materialFileOf(const std::string& name, const FittedCoefficients& fitted, double refractiveIndex,
                           const std::string& source) {
    const std::string wavelengths = listed(fitted.absorption.wavelengthsNm);
    return fmt::format("title = {}\nkind = \"film\"\nsource = {}\n\nrefractive_index = {:g}\n\n"
                       "[absorption]\nunit = \"1/um\"\nwavelengths_nm = [{}]\nvalues = [{}]\n\n"
                       "[scattering]\nunit = \"1/um\"\nwavelengths_nm = [{}]\nvalues = [{}]\n",
                       quoted(name), quoted(source), refractiveIndex, wavelengths, listed(fitted.absorption.values),
                       wavelengths, listed(fitted.scattering.values));
}

} // namespace patina
