#include "optics/layer_optics.h"

#include <algorithm>
#include <cmath>

namespace patina {

LayerOptics LayerOptics::of(double absorption, double scattering) {
    const double kappa =
        std::max(std::sqrt(absorption * (absorption + 2.0 * scattering)), 1e-6 * (absorption + scattering));
    const double perKappa = kappa > 0.0 ? 1.0 / kappa : 0.0;
    const double perKappaAbsorption = std::min(absorption * perKappa, 1.0);
    return {static_cast<float>(2.0 * kappa),
            static_cast<float>(scattering * perKappa),
            static_cast<float>(2.0 * perKappaAbsorption),
            static_cast<float>(-1.0 - perKappaAbsorption),
            static_cast<float>(perKappaAbsorption - 1.0),
            static_cast<float>(2.0 * (absorption + scattering))};
}

void LayerSpectra::setBand(int band, double absorptionPerUm, double scatteringPerUm) {
    const LayerOptics optics = LayerOptics::of(absorptionPerUm, scatteringPerUm);
    twoKappa[band] = optics.twoKappa;
    scattering[band] = optics.scattering;
    twoAbsorption[band] = optics.twoAbsorption;
    minusOnePlus[band] = optics.minusOnePlus;
    minusOneMinus[band] = optics.minusOneMinus;
    twoExtinction[band] = optics.twoExtinction;
}

} // namespace patina
