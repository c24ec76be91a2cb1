#pragma once
// Rays against a triangle mesh (Embree).

#include "surface/mesh.h"

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
    /// Up to 16 rays that are traced together: several times the speed of one after the other where they start near
    /// each other and go much the same way, as a camera's do. The last bits of a hit may depend on the company.
    static constexpr int packetSize = 16;
    struct Packet {
        int count = 0;
        bool coherent = false; ///< whether they go much the same way
        alignas(64) float originX[packetSize], originY[packetSize], originZ[packetSize];
        alignas(64) float directionX[packetSize], directionY[packetSize], directionZ[packetSize];
        alignas(64) float farthest[packetSize]; ///< in lengths of the direction

        void set(int ray, const Imath::V3f& origin, const Imath::V3f& direction, float reach) {
            originX[ray] = origin.x, originY[ray] = origin.y, originZ[ray] = origin.z;
            directionX[ray] = direction.x, directionY[ray] = direction.y, directionZ[ray] = direction.z;
            farthest[ray] = reach;
        }
    };
    /// \param hits  receives what each ray of the packet meets first
    void intersect(const Packet& packet, std::optional<Hit>* hits) const;
    /// Whether anything is hit between nearest and farthest.
    bool occluded(const Imath::V3f& origin, const Imath::V3f& direction, float nearest, float farthest) const;

    struct Closest {
        SurfacePoint point;
        float distance;
    };
    /// The closest point within the radius, degenerate triangles included; distance in scene units. Costs grow with the
    /// distance from the surface over the size of its triangles: pass a radius where one is known.
    std::optional<Closest> closest(const Imath::V3f& position,
                                   float radius = std::numeric_limits<float>::infinity()) const;

  private:
    struct Scene;
    std::unique_ptr<Scene> scene_;
};

} // namespace patina
