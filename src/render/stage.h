#pragma once
// A scene made ready for paths: where rays meet surface and floor, and what may be seen from there.

#include "base/vector_lanes.h"
#include "optics/bsdf_batch.h"
#include "optics/patina_bsdf.h"
#include "render/lights.h"
#include "render/path_kernels.h"
#include "render/scene.h"
#include "render/turntable.h"
#include "surface/ray_batch.h"
#include "surface/ray_scene.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace patina {

/// Where a path met floor or turntable.
struct StagePoint {
    Imath::V3f position{0.f};
    Imath::V3f origin{0.f}; ///< of rays that leave, clear of it
    Frame shading;
};

/// Where paths met something, turned to the side they came from.
struct SurfaceLanes {
    VectorLanes position; ///< on the triangle
    VectorLanes origin;   ///< of rays that leave: clear of the triangle, on the smooth surface it stands for
    VectorLanes tangent, bitangent, normal;

    void resize(std::size_t count);
    void set(std::size_t lane, const StagePoint& point);
    Frames frames();
};

/// A scene made ready for paths: where rays meet surface and floor, and what may be seen from there.
class Stage {
  public:
    /// \param scene  its surface must outlive the stage.
    Stage(const RenderScene& scene, const Lights& lights);
    /// For rays alone: the backdrop is black.
    explicit Stage(const RenderScene& scene);

    /// Whether a point lies inside a closed surface: most ways out of it meet backs first.
    bool isInside(const Imath::V3f& position) const;

    /// How far a ray has to be traced: beyond lies the floor, or nothing ever.
    float reach(const Imath::V3f& origin, const Imath::V3f& direction) const;
    /// The surface that rays are traced against.
    const RayScene& rays() const { return rays_; }
    /// Whether rays that meet nothing within their reach met the floor there, where that is finite.
    bool hasFloor() const { return scene_.ground; }
    bool isClosed() const { return scene_.surface->closed; }
    /// Where a ray meets floor or turntable, at its reach.
    StagePoint floorPoint(const Imath::V3f& origin, const Imath::V3f& direction) const;
    /// Where hits number from[0] … from[count - 1] are, as lanes; `from` and the lanes go on up to a multiple of 16.
    /// \param wo  receives the direction that each ray came from, in the lane's frame
    void shade(const RayBatch& rays, const HitBatch& hits, const std::vector<int>& from, std::size_t count,
               SurfaceLanes& at, VectorLanes& wo) const;
    /// Whether floor or turntable stand between the point and a light at this distance, infinity included: known
    /// without tracing anything.
    bool setBlocks(const Imath::V3f& from, const Imath::V3f& direction, float distance) const;

    /// Their materials, as lanes of a batch that has begun.
    void materials(const HitBatch& hits, const std::vector<int>& from, std::size_t count, BsdfBatch& into) const;
    const PatinaBsdf& floorMaterial() const { return floorMaterial_; }

    /// How far a point of the floor has faded into the backdrop: 0 near the object, 1 far away.
    float backdropShare(const Imath::V3f& floorPoint) const;
    const Imath::V3f& backdrop() const { return backdrop_; }
    /// What a camera ray sees that meets nothing: the lights, where there is no one colour for all of them.
    std::optional<Imath::V3f> seenByCamera() const;

  private:
    /// Where a ray meets floor or turntable; infinitely far away where it does not.
    struct Floor {
        float distance;
        Imath::V3f normal;
        bool isTable;
    };
    Floor floorAlong(const Imath::V3f& origin, const Imath::V3f& direction) const;

    RenderScene scene_;
    RayScene rays_;
    PatinaBsdf floorMaterial_;
    Frame upright_;
    Imath::V3f centre_;
    float radius_;      ///< half the diagonal of the box around the surface
    float floorHeight_; ///< along up
    std::optional<Turntable> table_;
    float clearance_; ///< rays start this far from what they leave
    Imath::V3f backdrop_{0.f};
};

} // namespace patina
