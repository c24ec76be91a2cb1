#pragma once
// A scene made ready for paths: where rays meet surface and floor, and what may be seen from there.

#include "optics/patina_bsdf.h"
#include "render/lights.h"
#include "render/scene.h"
#include "render/turntable.h"
#include "surface/ray_scene.h"

namespace patina {

/// A perfectly diffuse reflector, with SeenBsdf's functions.
struct SeenLambert {
    float albedo;

    BsdfValue evaluate(const Imath::V3f& wi) const;
    BsdfSample sample(const Imath::V3f& u) const;
};

enum class StageHit {
    nothing, ///< the ray leaves the scene
    surface,
    ground,
    inside, ///< the back of a closed surface: only rounding leads there
};

/// Where a path meets something, turned to the side it came from.
struct StagePoint {
    SurfacePoint surface;
    Imath::V3f position{0.f}; ///< on the triangle
    Imath::V3f origin{0.f};   ///< of rays that leave: clear of the triangle, on the smooth surface it stands for
    Frame shading;
};

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
    /// Where a ray ends that met `hit` first, or nothing within its reach. `indirect`: not a camera ray, so that the
    /// inside of a closed surface means an error of rounding.
    StageHit meet(const std::optional<RayScene::Hit>& hit, const Imath::V3f& origin, const Imath::V3f& direction,
                  bool indirect, StagePoint& point) const;
    /// Traces one ray and says where it ends.
    StageHit intersect(const Imath::V3f& origin, const Imath::V3f& direction, bool indirect, StagePoint& point) const;
    /// Whether floor or turntable stand between the point and a light at this distance, infinity included: known
    /// without tracing anything.
    bool setBlocks(const StagePoint& from, const Imath::V3f& direction, float distance) const;

    PatinaBsdf material(const StagePoint& point) const { return scene_.material(point.surface, point.position); }
    float groundAlbedo() const { return scene_.groundAlbedo; }

    /// How far a point of the floor has faded into the backdrop: 0 near the object, 1 far away.
    float backdropShare(const Imath::V3f& floorPoint) const;
    const Imath::V3f& backdrop() const { return backdrop_; }
    /// What a camera ray sees that meets nothing.
    Imath::V3f seenByCamera(const Lights& lights, const Imath::V3f& direction) const;

  private:
    /// Where a ray meets floor or turntable; infinitely far away where it does not.
    struct Floor {
        float distance;
        Imath::V3f normal;
        bool isTable;
    };
    Floor floorAlong(const Imath::V3f& origin, const Imath::V3f& direction) const;
    void shadeSurface(const RayScene::Hit& hit, const Imath::V3f& direction, bool back, StagePoint& point) const;

    RenderScene scene_;
    RayScene rays_;
    Frame upright_;
    Imath::V3f centre_;
    float radius_;      ///< half the diagonal of the box around the surface
    float floorHeight_; ///< along up
    std::optional<Turntable> table_;
    float clearance_; ///< rays start this far from what they leave
    Imath::V3f backdrop_{0.f};
};

} // namespace patina
