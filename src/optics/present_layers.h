#pragma once
// What the two models of StackOptics share beside its interface; for their source files only.

#include "optics/layer_stack.h"
#include "optics/rgb_lanes.h"

namespace patina {

/// The layers that are there, from bottom to top. Neighbours of one material are one layer: there is no interface
/// between them, and what depends on thickness (interference, a surface of its own) must not see where it was cut.
struct StackOptics::PresentLayers {
    int count = 0;
    int index[maxLayers]; ///< of the uppermost where several are one
    float thicknessUm[maxLayers];
    float weight[maxLayers]; ///< how much of its own interface it has, 0…1
};

/// What a look adds up to, for `flatten`.
struct StackOptics::LightSums {
    RgbLanes diffuse{};
    RgbLanes lobes{};
    RgbLanes metal{}; ///< of metals' lobes, without what the air reflects
    RgbLanes width{}; ///< lobes, each times its alpha²

    void add(const Layer& layer, RgbLanes lobe, RgbLanes air) {
        lobes += lobe;
        width += lobe * (layer.alpha * layer.alpha);
        metal += layer.isMetal ? lobe - air : RgbLanes{};
    }
};

/// Reflectance of the interface between two dielectrics for light from the normal.
inline float normalDielectric(float below, float above) {
    const float ratio = (below - above) / (below + above);
    return ratio * ratio;
}

} // namespace patina
