#pragma once
// A perspective camera that finds the object by itself.

#include "render/frame.h"
#include "surface/mesh.h"

#include <Imath/ImathBox.h>

#include <vector>

namespace patina {

struct CameraRay {
    Imath::V3f origin;
    Imath::V3f direction; ///< unit
};

/// Many of them, number by number. A pinhole's begin all at one place, which is not repeated.
struct CameraRays {
    std::vector<float> directionX, directionY, directionZ;
    std::vector<Imath::V3f> origins; ///< one, or one for each ray

    Imath::V3f origin(std::size_t i) const { return origins.size() == 1 ? origins.front() : origins[i]; }
    Imath::V3f direction(std::size_t i) const { return {directionX[i], directionY[i], directionZ[i]}; }
};

/// Where the camera stands relative to the object it looks at.
struct CameraView {
    UpAxis up = UpAxis::z;
    float azimuthDegrees = 0.f;    ///< 0: the model's front (frame.h); positive: walks to the right, around the model
    float elevationDegrees = 15.f; ///< above the horizon, -90…90
    float fieldOfViewDegrees =
        22.f;           ///< over the shorter side of the picture; 22 is a 90 mm portrait lens, 50 a wide one
    float fill = 0.86f; ///< the part of the picture's tighter side that the object takes up, 0…1
};

/// The view a photographer would take: statues from a little above and aside, flat things from well above, open sheets
/// from the side that their normals face.
CameraView automaticView(const SurfaceMesh& surface, UpAxis up);

class Camera {
  public:
    /// Looks along the view's direction, from the smallest distance at which every point lies in the filled part of the
    /// picture, centred in it. `aspect` is width / height.
    /// \throws RunError where there are no points, one is not finite, or an angle or the aspect is out of range.
    static Camera framed(const std::vector<Imath::V3f>& points, const CameraView& view, float aspect);
    /// The same for the corners of a box.
    static Camera framed(const Imath::Box3f& bounds, const CameraView& view, float aspect);

    /// Stands at a distance from a point that it has in the middle. \throws RunError as framed() does, and for a
    /// distance that is not above 0
    static Camera aimed(const Imath::V3f& target, float distance, const CameraView& view, float aspect);

    /// Gives the camera a lens of this radius, focused on the plane at this distance in front of it (scene units):
    /// what is nearer or further blurs. Radius 0: a pinhole, as cameras are made. \throws RunError
    void setLens(float radius, float focusDistance);

    /// The ray through a point of the picture: (0, 0) is its top left corner, (1, 1) its bottom right.
    /// \param lens  where on the lens it starts, uniform in 0 … 1 each; without a lens it does not matter
    CameraRay ray(float x, float y, const Imath::V2f& lens = Imath::V2f(0.5f)) const;
    /// The same for `count` points at once. \param lensU, lensV  not read without a lens
    void rays(const float* x, const float* y, const float* lensU, const float* lensV, std::size_t count,
              CameraRays& rays) const;
    bool hasLens() const { return lensRadius_ > 0.f; }
    /// Where a point appears in the picture, in the same coordinates. Only for points in front of the camera.
    Imath::V2f project(const Imath::V3f& point) const;

    /// Whether a ball reaches into the pyramid in front of the camera that the picture shows.
    bool sees(const Imath::V3f& centre, float radius) const;
    /// How much of the scene one of `height` pixels shows at this distance in front of the camera.
    float pixelAt(float depth, int height) const { return 2.f * depth * halfHeight_ / float(height); }

    const Imath::V3f& position() const { return position_; }
    const Imath::V3f& forward() const { return forward_; }

  private:
    static Camera oriented(const CameraView& view, float aspect);

    Imath::V3f position_, right_, upward_, forward_;
    float halfWidth_ = 1.f; ///< of the picture plane at distance 1
    float halfHeight_ = 1.f;
    float lensRadius_ = 0.f, focusDistance_ = 1.f;
};

} // namespace patina
