#pragma once
// What is in a picture.

#include "optics/patina_bsdf.h"
#include "render/frame.h"
#include "surface/mesh.h"

#include <Imath/ImathBox.h>

#include <functional>
#include <optional>

namespace patina {

/// The reflection of a point of the surface. `position` is where the ray hit, in scene units.
/// Called from many threads at once; must give the same answer for the same point.
using MaterialAt = std::function<PatinaBsdf(const SurfacePoint& point, const Imath::V3f& position)>;

/// A surface on a photographer's floor, or alone.
struct RenderScene {
    /// Already displaced, with shading normals. Open sheets show the same material from behind. Not owned.
    const SurfaceMesh* surface = nullptr;
    MaterialAt material;
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
