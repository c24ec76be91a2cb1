#include "render/camera.h"

#include "base/errors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {

namespace {

float radians(float degrees) {
    return degrees * float(M_PI) / 180.f;
}

std::vector<Imath::V3f> corners(const Imath::Box3f& box) {
    std::vector<Imath::V3f> points;
    for (int i = 0; i < 8; ++i)
        points.emplace_back(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y,
                            i & 4 ? box.max.z : box.min.z);
    return points;
}

} // namespace

CameraView automaticView(const SurfaceMesh& surface, UpAxis up) {
    CameraView view;
    view.up = up;
    const Frame set = uprightFrame(up);
    Imath::V3d area(0.0);
    double total = 0.0;
    Imath::Box3f box;
    for (const Imath::V3i& t : surface.triangles) {
        const Imath::V3f a = surface.positions[std::size_t(t.x)], b = surface.positions[std::size_t(t.y)],
                         c = surface.positions[std::size_t(t.z)];
        const Imath::V3d cross = Imath::V3d((b - a).cross(c - a));
        area += cross;
        total += cross.length();
        for (const Imath::V3f& p : {a, b, c})
            box.extendBy(set.toLocal(p));
    }
    // A sheet has a face: the area vectors of a closed surface add up to nothing, those of a flat one to its area.
    if (total > 0.0 && area.length() > 0.6 * total) {
        const Imath::V3f face = set.toLocal(Imath::V3f(area / area.length()));
        const float elevation = std::asin(std::clamp(face.z, -1.f, 1.f)) * 180.f / float(M_PI);
        // A little off the mirror direction, so that a flat sheet does not reflect the camera's own dark side.
        view.elevationDegrees = std::clamp(elevation < 60.f ? elevation + 12.f : 62.f, -80.f, 80.f);
        if (std::hypot(face.x, face.y) > 0.2f)
            view.azimuthDegrees = std::atan2(face.x, -face.y) * 180.f / float(M_PI) + 10.f;
        return view;
    }
    // From 12 degrees for what stands upright to 40 for what lies flat: a flat thing shows its face only from above.
    const Imath::V3f size = box.size();
    const float upright = std::clamp(2.f * size.z / std::max({size.x, size.y, 1e-20f}), 0.f, 1.f);
    view.elevationDegrees = 40.f + (12.f - 40.f) * upright;
    view.azimuthDegrees = 20.f;
    return view;
}

Camera Camera::framed(const Imath::Box3f& bounds, const CameraView& view, float aspect) {
    if (bounds.isEmpty())
        throw RunError("camera", "there is nothing to look at");
    return framed(corners(bounds), view, aspect);
}

Camera Camera::oriented(const CameraView& view, float aspect) {
    if (!(aspect > 0.01f && aspect < 100.f))
        throw RunError("camera", "the picture's sides must not differ by more than a factor of 100");
    if (!(view.fieldOfViewDegrees >= 0.5f && view.fieldOfViewDegrees <= 150.f))
        throw RunError("camera", "the field of view must be 0.5 to 150 degrees");
    if (!(std::abs(view.elevationDegrees) <= 90.f) || !std::isfinite(view.azimuthDegrees))
        throw RunError("camera", "the elevation must be -90 to 90 degrees, the azimuth a number");
    if (!(view.fill > 0.01f && view.fill <= 1.f))
        throw RunError("camera", "the filled part of the picture must be above 0.01 and at most 1");

    Camera camera;
    const Frame set = uprightFrame(view.up, view.azimuthDegrees);
    const float elevation = radians(view.elevationDegrees);
    const Imath::V3f toViewer = -set.bitangent;
    camera.forward_ = -(toViewer * std::cos(elevation) + set.normal * std::sin(elevation)).normalized();
    camera.right_ = set.tangent;
    camera.upward_ = camera.right_.cross(camera.forward_).normalized();
    const float half = std::tan(0.5f * radians(view.fieldOfViewDegrees));
    camera.halfWidth_ = half * std::max(aspect, 1.f);
    camera.halfHeight_ = half * std::max(1.f / aspect, 1.f);
    return camera;
}

Camera Camera::aimed(const Imath::V3f& target, float distance, const CameraView& view, float aspect) {
    if (!(distance > 0.f) || !std::isfinite(distance))
        throw RunError("camera", "its distance must be above 0");
    if (!std::isfinite(target.x + target.y + target.z))
        throw RunError("camera", "the point to look at is not finite");
    Camera camera = oriented(view, aspect);
    camera.position_ = target - camera.forward_ * distance;
    return camera;
}

Camera Camera::framed(const std::vector<Imath::V3f>& points, const CameraView& view, float aspect) {
    if (points.empty())
        throw RunError("camera", "there is nothing to look at");
    Camera camera = oriented(view, aspect);
    // With the camera at (cx, cy, -d) in its own axes, a point (x, y, z) lies left of the right edge where
    // x - cx <= t (d + z), and right of the left edge where cx - x <= t (d + z). So d t + cx >= A = max(x - t z) and
    // d t - cx >= B = max(-x - t z): the smallest d is (A + B) / 2t and it centres the points at cx = (A - B) / 2.
    constexpr float none = -std::numeric_limits<float>::infinity();
    const float tx = camera.halfWidth_ * view.fill;
    const float ty = camera.halfHeight_ * view.fill;
    float right = none, left = none, top = none, bottom = none, nearest = none;
    Imath::Box3f box;
    for (const Imath::V3f& p : points)
        box.extendBy(p);
    const Imath::V3f centre = box.center();
    for (const Imath::V3f& p : points) {
        const Imath::V3f q = p - centre;
        if (!std::isfinite(q.x) || !std::isfinite(q.y) || !std::isfinite(q.z))
            throw RunError("camera", "a point to look at is not finite");
        const float x = q ^ camera.right_, y = q ^ camera.upward_, z = q ^ camera.forward_;
        right = std::max(right, x - tx * z), left = std::max(left, -x - tx * z);
        top = std::max(top, y - ty * z), bottom = std::max(bottom, -y - ty * z);
        nearest = std::max(nearest, -z);
    }
    const float extent = std::max(box.size().length(), 1e-20f);
    const float distance =
        std::max({(right + left) / (2.f * tx), (top + bottom) / (2.f * ty), nearest + 0.05f * extent});
    camera.position_ = centre + camera.right_ * (0.5f * (right - left)) + camera.upward_ * (0.5f * (top - bottom)) -
                       camera.forward_ * distance;
    return camera;
}

void Camera::setLens(float radius, float focusDistance) {
    if (!(radius >= 0.f) || !(focusDistance > 0.f) || !std::isfinite(radius + focusDistance))
        throw RunError("camera", "its lens must have a radius of 0 or more and focus in front of it");
    lensRadius_ = radius;
    focusDistance_ = focusDistance;
}

CameraRay Camera::ray(float x, float y, const Imath::V2f& lens) const {
    const Imath::V3f direction =
        forward_ + right_ * ((2.f * x - 1.f) * halfWidth_) + upward_ * ((1.f - 2.f * y) * halfHeight_);
    if (lensRadius_ == 0.f)
        return {position_, direction.normalized()};
    // All rays through the lens meet where the ray through its middle crosses the plane in focus.
    const float r = lensRadius_ * std::sqrt(lens.x), phi = 2.f * float(M_PI) * lens.y;
    const Imath::V3f aside = right_ * (r * std::cos(phi)) + upward_ * (r * std::sin(phi));
    return {position_ + aside, (direction * focusDistance_ - aside).normalized()};
}

void Camera::rays(const float* x, const float* y, const float* lensU, const float* lensV, std::size_t count,
                  CameraRays& rays) const {
    for (auto* numbers : {&rays.directionX, &rays.directionY, &rays.directionZ})
        numbers->resize(count);
    rays.origins.clear();
    if (hasLens()) {
        for (std::size_t i = 0; i < count; ++i) {
            const CameraRay one = ray(x[i], y[i], {lensU[i], lensV[i]});
            rays.origins.push_back(one.origin);
            rays.directionX[i] = one.direction.x;
            rays.directionY[i] = one.direction.y;
            rays.directionZ[i] = one.direction.z;
        }
        return;
    }
    rays.origins.push_back(position_);
    const auto spread = [&](float forward, float right, float upward, float* to) {
        for (std::size_t i = 0; i < count; ++i)
            to[i] = forward + right * ((2.f * x[i] - 1.f) * halfWidth_) + upward * ((1.f - 2.f * y[i]) * halfHeight_);
    };
    float *dx = rays.directionX.data(), *dy = rays.directionY.data(), *dz = rays.directionZ.data();
    spread(forward_.x, right_.x, upward_.x, dx);
    spread(forward_.y, right_.y, upward_.y, dy);
    spread(forward_.z, right_.z, upward_.z, dz);
    for (std::size_t i = 0; i < count; ++i) {
        const float length = std::sqrt(dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i]);
        dx[i] /= length;
        dy[i] /= length;
        dz[i] /= length;
    }
}

bool Camera::sees(const Imath::V3f& centre, float radius) const {
    const Imath::V3f q = centre - position_;
    const float x = std::abs(q ^ right_), y = std::abs(q ^ upward_), z = q ^ forward_;
    // The distance from the pyramid's sides, whose normals are (1, 0, -half) and (0, 1, -half) over their lengths.
    const float reach = radius + lensRadius_;
    return z >= -reach && x - halfWidth_ * z <= reach * std::sqrt(1.f + halfWidth_ * halfWidth_) &&
           y - halfHeight_ * z <= reach * std::sqrt(1.f + halfHeight_ * halfHeight_);
}

Imath::V2f Camera::project(const Imath::V3f& point) const {
    const Imath::V3f q = point - position_;
    const float z = q ^ forward_;
    return {0.5f + 0.5f * (q ^ right_) / (z * halfWidth_), 0.5f - 0.5f * (q ^ upward_) / (z * halfHeight_)};
}

} // namespace patina
