#include "picture_budget.h"

#include "table_pose.h"
#include "view_input.h"

#include "render/dice.h"

#include <algorithm>
#include <cmath>

namespace patina::tool {

namespace {

// Measured on spheres and the statuette, pictures of 256 to 1024 pixels: splitting edges at their middles leaves 7 to
// 10 triangles where one square of the longest edge was covered, and each takes so much with its vertices, their
// stacks, its displaced copy and its tree.
constexpr double trianglesPerSquare = 7.6, bytesPerTriangle = 275.0;

} // namespace

double pictureBytes(const Options& options, const Model& model) {
    if (options.pictureSize <= 0)
        return 0.0;
    SurfaceMesh sketch = model.surface;
    Turn turn;
    if (model.region) {
        turn = poseOnTable(sketch, options.up);
        turn.apply(sketch);
    }
    Subject subject;
    subject.surface = &sketch;
    subject.fromModel = [&](const Imath::V3d& point) { return turn(Imath::V3f(model.toLocal(point))); };
    subject.unitsPerModelUnit = model.magnification();
    subject.metresPerModelUnit = model.scale.metresPerUnit * model.magnification();
    const View view = options.view ? *options.view : viewOf(options, subject);
    const double pixels = double(view.width) * view.height;

    double triangles = double(sketch.triangles.size());
    if (options.dice > 0.0) {
        double covered = 0.0;                             // squares of the longest edge
        const double voxel = 1.5 * model.scale.voxelSize; // edges of what is displaced are no longer
        for (const Imath::V3i& t : sketch.triangles) {
            const Imath::V3f corners[3] = {sketch.positions[t.x], sketch.positions[t.y], sketch.positions[t.z]};
            const Imath::V3f middle = (corners[0] + corners[1] + corners[2]) / 3.f;
            const Imath::V3f normal = (corners[1] - corners[0]) % (corners[2] - corners[0]);
            float radius = 0.f;
            for (const Imath::V3f& corner : corners)
                radius = std::max(radius, (corner - middle).length());
            const float depth = (middle - view.camera.position()) ^ view.camera.forward();
            if ((normal ^ (view.camera.position() - middle)) <= 0.f || !(depth > 0.f) ||
                !view.camera.sees(middle, radius))
                continue;
            const double edge = std::min(options.dice * view.camera.pixelAt(depth, view.height), voxel);
            covered += 0.5 * normal.length() / (edge * edge);
        }
        // The round in which there are too many is the last, and may double them.
        triangles = std::min(triangles + covered * trianglesPerSquare, 2.0 * double(DiceOptions().mostTriangles));
    }
    return triangles * bytesPerTriangle + pixels * bytesPerPixel;
}

} // namespace patina::tool
