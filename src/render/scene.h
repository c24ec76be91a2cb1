#pragma once
// What is in a picture.

#include "optics/bsdf_batch.h"
#include "optics/patina_bsdf.h"
#include "render/frame.h"
#include "surface/mesh.h"
#include "surface/ray_batch.h"

#include <Imath/ImathBox.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace patina {

/// The reflection of a point of the surface. `position` is where the ray hit, in scene units.
/// Called from many threads at once; must give the same answer for the same point.
using MaterialAt = std::function<PatinaBsdf(const SurfacePoint& point, const Imath::V3f& position)>;

/// The same for many points: those that hits number from[0] … from[count - 1] are at, as lanes 0 … count - 1 of a batch
/// that has begun. `from` has room up to the next group of lanes, filled with valid numbers.
using MaterialsAt =
    std::function<void(const HitBatch& hits, const std::vector<int>& from, std::size_t count, BsdfBatch& into)>;

/// A surface on a photographer's floor, or alone.
struct RenderScene {
    /// Already displaced, with shading normals. Open sheets show the same material from behind. Not owned.
    const SurfaceMesh* surface = nullptr;
    MaterialAt material;
    MaterialsAt materials; ///< must agree with `material`; without it, that is asked point by point
    UpAxis up = UpAxis::z;

    /// A matte floor under the lowest point, lit and shadowed, that fades into a plain backdrop with distance.
    bool ground = true;
    /// What floor and backdrop are placed by, where several pictures share them; without it, the surface's own box.
    std::optional<Imath::Box3f> setting;
    float groundAlbedo = 0.42f;
    bool turntable = false; ///< on that floor a round table, under the object
    /// What the camera sees past a scene without ground; without it, the environment.
    std::optional<Imath::V3f> background;
};

} // namespace patina
