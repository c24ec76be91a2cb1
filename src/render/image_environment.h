#pragma once
// A photographed surrounding: a panorama in equal steps of azimuth and elevation.

#include "render/environment.h"
#include "render/image.h"

#include <filesystem>

namespace patina {

/// Light from a panorama of twice its height in width: its middle column lies ahead of a viewer who stands at azimuth 0
/// and looks at the model, the top row is up. Linear Rec.709, bilinear between pixels.
class ImageEnvironment final : public Environment {
  public:
    /// \param turnDegrees  counter-clockwise about up, seen from above
    /// \param strength     factor on the radiance, 0 or more
    /// \throws RunError where the picture is not twice as wide as high or some radiance is negative or not finite
    ImageEnvironment(Image panorama, UpAxis up, float turnDegrees = 0.f, float strength = 1.f);
    Imath::V3f radiance(const Imath::V3f& direction) const override;
    void radiance(const RadianceLanes& lanes) const override;
    int looksPerCell() const override;

  private:
    Image panorama_; ///< times the strength
    Frame set_;
};

/// Reads a panorama: OpenEXR, Radiance HDR or any other picture; pictures of 8 or 16 bits are decoded from sRGB.
/// \throws RunError where it cannot be read
Image readPanorama(const std::filesystem::path& path);

} // namespace patina
