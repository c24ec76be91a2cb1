#pragma once
// The picture of a core sample: layers in their colours, scale bars, a legend (Dorsey & Hanrahan 1996, figure 3).

#include "render/image.h"
#include "volume/layer_volume.h"

#include <Imath/ImathVec.h>

#include <string>
#include <vector>

namespace patina {

struct SectionOptions {
    Imath::V3d at{0.0};              ///< on the metal, scene units: the middle of the picture
    Imath::V3d along{1.0, 0.0, 0.0}; ///< the direction from left to right
    double width = 0.0;              ///< scene units that the cut is long; 0: 48 voxels
    double stretch = 0.0;   ///< how many times life size thickness is drawn against length; 0: to fit the picture
    bool unrolled = true;   ///< the surface as a straight line; otherwise the plane as it is, thickness as drawn
    int pictureWidth = 960; ///< pixels, legend included
    std::string title;
};

/// What a layer looks like in the picture and is called in the legend.
struct SectionMaterial {
    std::string name;
    Imath::V3f colour; ///< encoded for display
};

struct SectionPicture {
    Image image; ///< encoded for display
    bool hasText = true;
    double stretch = 1.0;                ///< as drawn
    std::vector<double> meanThicknessUm; ///< of each layer along the cut, real
    double rowsPerUm = 0.0;              ///< rows of pixels to a real micrometre of thickness
    double metalRow = 0.0;               ///< the row of the metal's surface as it was before any erosion
    double cutFraction = 1.0;            ///< how much of the width the cut reached: less where the surface ends
};

/// Unrolls the metal's surface along the cut into a straight line and draws what stands on it, along its normals.
/// Pores and overhangs are drawn where the volume has them. Where the metal itself was eroded, what is left of it is
/// drawn, and a dashed line where its surface was.
/// \param materials  the metal, then the layers bottom to top
/// \throws RunError where there is no metal at the place
SectionPicture drawSection(const LayerVolume& volume, const std::vector<SectionMaterial>& materials,
                           const SectionOptions& options);

} // namespace patina
