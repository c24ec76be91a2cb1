#pragma once
// What a run on a region needs of the model: the piece around the box, and the whole for signs, shadows and patterns.

#include "surface/ray_scene.h"
#include "surface/region_cutter.h"
#include "volume/region.h"

#include <memory>

namespace patina {

/// A region cut out of a model. What is called local is in the volume's coordinates, see Region.
class RegionModel {
  public:
    struct Options {
        LimitSurfaceOptions limit;
        Imath::V3d up{0.0, 1.0, 0.0};
        int resolution = 1024; ///< of the maps: gaps between charts
    };

    /// \throws Error (command line) where the box holds no surface, with the nearest point that there is; ModelError
    RegionModel(Mesh mesh, const Region& region, const Options& options);
    RegionModel(const RegionModel&) = delete;
    RegionModel& operator=(const RegionModel&) = delete;

    const Region& region() const { return region_; }

    /// The piece that is worked on, local: to the region's surfaceBox(), with the model's own UVs, attributes and
    /// normals, sides settled (settleSides).
    const SurfaceMesh& work() const { return work_; }
    /// The piece in the box, local: what maps are baked and pictures made of. UVs of its own that fill the tile; no
    /// edge longer than two voxels; a scan's facets have their own normals, smooth only across their edges.
    const SurfaceMesh& shown() const { return shown_; }
    /// The same, coarser, in the model's coordinates: what goes into NAME.obj.
    const Mesh& control() const { return control_; }

    /// The whole model's surface, model coordinates.
    const SurfaceMesh& whole() const { return cutter_.whole(); }
    double longestSide() const { return cutter_.longestSide(); } ///< of the whole, scene units
    /// Rays through the whole model, local.
    const RayScene& wholeScene() const { return wholeScene_; }

    /// The whole's triangles from which patterns grow that reach `margin` (scene units) beyond the voxels: model
    /// coordinates. Of cages half the edges are no longer than `edge`.
    SurfaceMesh growthSurface(double margin, double edge) const;

    /// The shown surface of a control mesh as NAME.obj holds it (see Region::pieceHash).
    static SurfaceMesh shownFrom(const Mesh& control, const Region& region);
    static std::string hashOf(const Mesh& control);

  private:
    Mesh mesh_;
    Region region_;
    RegionCutter cutter_;
    RayScene wholeScene_;
    SurfaceMesh work_, shown_;
    Mesh control_;
};

} // namespace patina
