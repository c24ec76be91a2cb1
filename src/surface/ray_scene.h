#pragma once
// Rays against a triangle mesh (Embree).

#include "surface/mesh.h"
#include "surface/ray_batch.h"

#include <limits>
#include <memory>
#include <optional>

namespace patina {

/// Immutable after construction; every query is safe from any thread. Copies the mesh, and answers the same whatever
/// the number of threads that built it: where triangles tie, the smallest index wins. \throws RunError on construction
/// where memory does not suffice.
class RayScene {
  public:
    RayScene(const std::vector<Imath::V3f>& positions, const std::vector<Imath::V3i>& triangles);
    ~RayScene();
    RayScene(RayScene&&) noexcept;
    RayScene& operator=(RayScene&&) noexcept;

    struct Hit {
        SurfacePoint point;
        float distance;
        Imath::V3f geometricNormal; ///< not normalised, by the triangle's winding
    };
    /// The first hit with nearest ≤ distance ≤ farthest, distances in lengths of `direction`. Watertight along edges.
    std::optional<Hit> intersect(const Imath::V3f& origin, const Imath::V3f& direction, float nearest = 0.f,
                                 float farthest = std::numeric_limits<float>::infinity()) const;
    struct FaceHit {
        float distance;    ///< lengths of the ray's direction
        Imath::V3f normal; ///< unit, by the triangle's winding
        float width;       ///< smallest height of the triangle, scene units
    };
    /// The same with what the first triangle is like.
    std::optional<FaceHit> firstFace(const Imath::V3f& origin, const Imath::V3f& direction, float farthest) const;
    /// What each ray of a batch meets first, from its origin on. Traced in packets of `packetSize` that follow each
    /// other in the batch. The last bits of a hit may depend on the packet's company. \param coherent  the rays of a
    /// packet start near each other and go much the same way, as a camera's do: three times the speed for those, and
    /// half of it for others
    void intersect(const RayBatch& rays, bool coherent, HitBatch& hits) const;
    static constexpr int packetSize = 16;
    /// Whether anything is hit between nearest and farthest.
    bool occluded(const Imath::V3f& origin, const Imath::V3f& direction, float nearest, float farthest) const;
    /// The same for a batch, from the origins on: a third to half of the time where there are hundreds.
    /// \param blocked  receives 0 or 1 for each ray
    void occluded(const RayBatch& rays, std::vector<char>& blocked) const;

    struct Closest {
        SurfacePoint point;
        float distance;
    };
    /// The closest point within the radius, degenerate triangles included; distance in scene units. Costs grow with the
    /// distance from the surface over the size of its triangles: pass a radius where one is known.
    std::optional<Closest> closest(const Imath::V3f& position,
                                   float radius = std::numeric_limits<float>::infinity()) const;
    /// The same among triangles whose normals, by their winding, lie within 72 degrees of a direction: of two surfaces
    /// that face each other, the one that faces this way.
    /// \param unlike  a unit normal: where it is given, only triangles that are turned against it by 37 degrees or more
    std::optional<Closest> closestFacing(const Imath::V3f& position, const Imath::V3f& direction, float radius,
                                         const Imath::V3f& unlike = Imath::V3f(0.f)) const;

  private:
    struct Scene;
    std::optional<Closest> search(const Imath::V3f& position, float radius, const Imath::V3f& facing,
                                  const Imath::V3f& unlike) const;
    std::unique_ptr<Scene> scene_;
};

} // namespace patina
