#pragma once
// What a layer is made of, as the inner loop of StackOptics wants it.

#include "optics/spectrum.h"

namespace patina {

/// K and S of one band as the kernel wants them. kappa = sqrt(K (K + 2 S)) is kept above 1e-6 (K + S): so S / kappa is
/// finite, and what it changes, a white layer that would return more than 0.999999, cannot be seen.
struct LayerOptics {
    float twoKappa;      ///< 1/µm
    float scattering;    ///< S / kappa
    float twoAbsorption; ///< 2 K / kappa
    float minusOnePlus;  ///< -(1 + K / kappa)
    float minusOneMinus; ///< -(1 - K / kappa); never positive
    float twoExtinction; ///< 2 (K + S), 1/µm

    static LayerOptics of(double absorption, double scattering);
};

/// LayerOptics of all bands.
struct LayerSpectra {
    Spectrum twoKappa, scattering, twoAbsorption, minusOnePlus, minusOneMinus, twoExtinction;

    void setBand(int band, double absorption, double scattering);
};

} // namespace patina
