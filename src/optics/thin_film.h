#pragma once
// Interference in films of less than a wave on metal: the colours of a copper sheet's first weeks.

#include "optics/spectrum.h"

#include <complex>
#include <vector>

namespace patina {

struct Material;

/// One film of a stack that is thin and smooth enough for waves to keep their phase.
struct CoherentFilm {
    std::complex<double> index; ///< n + i k
    double thicknessUm = 0.0;
};

/// Reflectance of unpolarised light, 0…1, by the transfer matrices of the films (Abelès 1950; Born & Wolf §1.6).
/// \param films      from the outside in; none leaves Fresnel's reflectance of `substrate`
/// \param substrate  n + i k, endless
/// \param cosine     to the normal, outside, 0…1
/// \param outside    index of the medium that light comes from, real
double coherentReflectance(const std::vector<CoherentFilm>& films, std::complex<double> substrate, double wavelengthNm,
                           double cosine = 1.0, double outside = 1.0);

/// Films thicker than this do not interfere: what is left of their colours is washed out by uneven thickness.
constexpr float thickestInterferingUm = 0.15f;

/// How much of a film's colour is interference, 1 below 0.1 µm, 0 from 0.15 µm on; smooth.
float interferingShare(float thicknessUm);

/// Reflectance of a metal under a film of 0 … 0.15 µm, from the air, at normal incidence.
class ThinFilmTable {
  public:
    /// \param metal, film  materials with `hasIndex`
    ThinFilmTable(const Material& metal, const Material& film);

    /// Linear between steps of 1 nm, which is within 0.001 of the exact reflectance; clamped to the table's range.
    void lookUp(float thicknessUm, Spectrum& reflectance) const;

  private:
    std::vector<Spectrum> steps_;
};

} // namespace patina
