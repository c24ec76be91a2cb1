#include "optics/thin_film.h"

#include "optics/material.h"

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

using Complex = std::complex<double>;

constexpr double pi = 3.14159265358979323846;
constexpr float firstFadingUm = 0.1f;
constexpr int tableSteps = 150;

enum class Polarisation { perpendicular, parallel };

// With n + i k a wave that goes down dies out as exp(i k0 N z), so of the two roots the one with Im >= 0 is meant.
Complex cosineInside(Complex index, double sineOutside) {
    const Complex sine = sineOutside / index;
    Complex cosine = std::sqrt(1.0 - sine * sine);
    if ((index * cosine).imag() < 0.0) {
        cosine = -cosine;
    }
    return cosine;
}

Complex admittance(Complex index, Complex cosine, Polarisation polarisation) {
    return polarisation == Polarisation::perpendicular ? index * cosine : index / cosine;
}

// The tangential fields above a film are (E, H) = M (E, H) below it, M = (cos d, -i sin d / y; -i y sin d, cos d) with
// the phase d = k0 N t cos and the admittance y. Below all films H = y_s E. Only H / E counts, so each matrix is divided
// by exp(Im d): nothing overflows however thick a film is.
double reflectanceOf(const std::vector<CoherentFilm>& films, Complex substrate, double wavelengthNm, double cosine,
                     double outside, Polarisation polarisation) {
    const double sineOutside = outside * std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    Complex e = 1.0;
    Complex h = admittance(substrate, cosineInside(substrate, sineOutside), polarisation);
    for (auto film = films.rbegin(); film != films.rend(); ++film) {
        const Complex inside = cosineInside(film->index, sineOutside);
        const Complex y = admittance(film->index, inside, polarisation);
        const Complex phase = 2.0 * pi * 1e3 * film->thicknessUm / wavelengthNm * film->index * inside;
        // exp(i d) and exp(-i d), both over exp(Im d).
        const Complex forth = std::polar(std::exp(-2.0 * phase.imag()), phase.real());
        const Complex back = std::polar(1.0, -phase.real());
        const Complex c = 0.5 * (forth + back);
        const Complex minusIS = 0.5 * (back - forth); // -i sin d
        const Complex above = c * e + minusIS * h / y;
        h = minusIS * y * e + c * h;
        e = above;
    }
    const double y0 = polarisation == Polarisation::perpendicular ? outside * cosine : outside / cosine;
    return std::norm((y0 * e - h) / (y0 * e + h));
}

Complex indexAt(const Material& material, int band) {
    return {material.indexN[band], material.indexK[band]};
}

} // namespace

double coherentReflectance(const std::vector<CoherentFilm>& films, Complex substrate, double wavelengthNm,
                           double cosine, double outside) {
    if (!(cosine > 1e-9)) {
        return 1.0;
    }
    const double c = std::min(cosine, 1.0);
    const double r =
        0.5 * (reflectanceOf(films, substrate, wavelengthNm, c, outside, Polarisation::perpendicular) +
               reflectanceOf(films, substrate, wavelengthNm, c, outside, Polarisation::parallel));
    return std::clamp(r, 0.0, 1.0);
}

float interferingShare(float thicknessUm) {
    const float x =
        std::clamp((thicknessUm - firstFadingUm) / (thickestInterferingUm - firstFadingUm), 0.f, 1.f);
    return 1.f - x * x * (3.f - 2.f * x);
}

ThinFilmTable::ThinFilmTable(const Material& metal, const Material& film) : steps_(tableSteps + 1) {
    std::vector<CoherentFilm> films(1);
    for (int band = 0; band < bandCount; ++band) {
        films[0].index = indexAt(film, band);
        for (int step = 0; step <= tableSteps; ++step) {
            films[0].thicknessUm = thickestInterferingUm * step / tableSteps;
            steps_[step][band] =
                static_cast<float>(coherentReflectance(films, indexAt(metal, band), bandWavelengthNm(band)));
        }
        // As the stack has the bare metal, to the bit: it must not change where the film begins.
        steps_[0][band] = metal.reflectance[band];
    }
}

void ThinFilmTable::lookUp(float thicknessUm, Spectrum& reflectance) const {
    const float position =
        std::clamp(thicknessUm / thickestInterferingUm * tableSteps, 0.f, static_cast<float>(tableSteps));
    const int below = std::min(static_cast<int>(position), tableSteps - 1);
    const float weight = position - static_cast<float>(below);
    const Spectrum& a = steps_[below];
    const Spectrum& b = steps_[below + 1];
    for (int band = 0; band < bandCount; ++band) {
        reflectance[band] = a[band] + weight * (b[band] - a[band]);
    }
}

} // namespace patina
