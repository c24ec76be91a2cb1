#pragma once
// What a texel shows: the stack at points of its footprint, averaged.

#include "export/bake.h"
#include "export/outer_surface.h"
#include "operators/maps/thickness_map.h"
#include "surface/surface_walk.h"
#include "surface/uv_frame.h"
#include "volume/stack_probe.h"

#include <array>
#include <vector>

namespace patina {

/// Means over a texel's points.
struct TexelValues {
    int points = 0, unreadable = 0, folds = 0;
    double baseOffset = 0.0,
           baseOffset2 = 0.0; ///< of the voxels' base from the surface, voxels: largest, sum of squares
    int visible = 0;          ///< the outermost layer at most points, 0: the metal
    double height = 0.0;      ///< scene units of the volume, as drawn
    Imath::V3d vector{0.0};
    std::vector<double> thicknessUm;
    std::vector<double> coverage; ///< [0] of the bare metal, [k] of layer k; their sum is 1
    std::vector<double> fields;
    Imath::V3d diffuse, baseColour;
    std::vector<Imath::V3d> lobes;
    double metallic = 0.0, roughness = 0.0;
};

/// Reads a volume for its maps; safe from any thread, each with a Scratch of its own.
///
/// Relief below a texel. A lobe of GGX (or Beckmann) width alpha is the light of facets whose slopes have the mean
/// square alpha²; relief that no map shows tilts these facets by a further slope s, the gradient of the height along
/// the surface, less its mean over the texel, which the maps do show. Independent slopes add by their squares: alpha'²
/// = alpha² + E|s - E s|², isotropic as roughness maps are (Olano and Baker 2010, LEAN mapping, whose covariance is
/// replaced by half its trace). `roughness` is the root of alpha'.
class TexelSampler {
  public:
    TexelSampler(const LayerVolume& volume, const SurfaceWalk& walk, const StackOptics& optics,
                 const BakeOptions& options);

    struct Scratch {
        Appearance look;
        std::vector<double> thickness;
        std::vector<float> thicknessUm;
    };

    double voxelSize() const { return voxelSize_; } ///< scene units

    /// Points along each side of a texel of this triangle: 1 where it is no wider than a voxel, 4 at most.
    int pointsAcross(int triangle) const;

    /// \param across  points along each side of the texel; 1: its middle
    void read(const SurfacePoint& middle, int across, bool askFolds, Scratch& scratch, TexelValues& out) const;

    /// TexelValues::height alone.
    double height(const SurfacePoint& middle, int across, Scratch& scratch) const;

  private:
    /// The points of a texel, in order.
    template <typename Use>
    void eachPoint(const SurfacePoint& middle, int across, const Use& use) const;
    struct Sums {
        Imath::V3d slope{0.0};
        double slope2 = 0.0, alpha2 = 0.0;
    };
    void readPoint(const SurfacePoint& point, bool askFolds, bool wantSlope, Scratch& scratch, TexelValues& out,
                   Sums& sums) const;

    const LayerVolume& volume_;
    const SurfaceWalk& walk_;
    const SurfaceMesh& surface_;
    const StackOptics& optics_;
    StackProbe probe_;
    OuterSurface outer_;
    std::vector<ThicknessMapPtr> fields_;
    double voxelSize_, slopeScale_;
    int layers_, resolution_;
    bool vectors_;
};

} // namespace patina
