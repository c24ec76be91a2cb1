#pragma once
// One path of light, from the camera to where it came from.

#include "render/lights.h"
#include "render/path_tracer.h"
#include "render/pixel_sampler.h"
#include "render/stage.h"

#include <cstdint>
#include <optional>

namespace patina {

/// What all paths of a picture share.
struct PathSetting {
    const Stage& stage;
    const Lights& lights;
    const RenderOptions& options;
};

class PathWalk {
  public:
    /// Draws that a surface takes: which light, three lights, two for a direction, roulette. Before them comes the
    /// camera's.
    static constexpr int drawsPerVertex = 7;

    /// A ray of the camera. \param sampler  of its pixel, at the path's sample
    PathWalk(const PathSetting& setting, const Imath::V3f& origin, const Imath::V3f& direction, PixelSampler& sampler)
        : setting_(setting), origin_(origin), direction_(direction), sampler_(sampler) {}

    /// The light that it carries. Once. \param first  what the camera's ray met
    Imath::V3f radiance(const std::optional<RayScene::Hit>& first);
    /// Traced so far, shadow rays included.
    std::uint64_t rays() const { return rays_; }

  private:
    /// Goes on from what the ray met to the next direction. \returns false where the path ends.
    bool arrive(const std::optional<RayScene::Hit>& hit);
    /// Light sampled from here, then a direction to go on in. \returns false where the path ends.
    template <typename Bsdf>
    bool scatter(const Bsdf& bsdf, const StagePoint& point);
    /// A shadow ray to a light, which is sampled with this density in all.
    template <typename Bsdf>
    void lookAt(const Bsdf& bsdf, const StagePoint& point, const Imath::V3f& direction, const Imath::V3f& radiance,
                float density, float distance);
    /// Light in the scene that the ray passed before it met what is `farthest` away.
    void meetAreaLights(float farthest);
    /// The light of a path that leaves the scene.
    void meetLights();
    /// Light times what is left of it, bounded where it is indirect.
    void add(const Imath::V3f& light, bool indirect);

    const PathSetting& setting_;
    Imath::V3f origin_, direction_;
    Imath::V3f light_{0.f};
    Imath::V3f throughput_{1.f};
    PixelSampler& sampler_;
    Lights::Aim aim_;          ///< for the surface that the ray left
    Imath::V3f normal_{0.f};   ///< of that surface
    bool lightsDone_ = false;  ///< the surface that the ray left has all direct light already
    float directionPdf_ = 0.f; ///< of the ray, by its BSDF
    int depth_ = 0;
    std::uint64_t rays_ = 0;
};

} // namespace patina
