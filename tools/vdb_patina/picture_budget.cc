#include "picture_budget.h"

#include "picture_dice.h"
#include "table_pose.h"
#include "view_input.h"

namespace patina::tool {

namespace {

// Of a triangle as it is traced, with its half vertex: the diced surface and its displaced copy, 24 each; the seams,
// 16; height and the metal's look, 25; Embree's tree with its buffers and our corners, 156. Every layer adds its
// thickness and its lobe, 36 a vertex. Measured on spheres and pieces of the statuette under one, three and six layers.
constexpr double bytesPerTriangle = 245.0, bytesPerTriangleAndLayer = 18.0;

} // namespace

double pictureBytes(const Options& options, const Model& model, int layers) {
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
    std::size_t triangles = sketch.triangles.size();
    if (options.dice > 0.0 && layers > 0)
        triangles = dicedTriangles(sketch, view.camera, dicingOf(view, options, model.scale.voxelSize));
    return double(triangles) * (bytesPerTriangle + layers * bytesPerTriangleAndLayer) +
           bytesPerPixel(options.exr) * view.width * view.height;
}

} // namespace patina::tool
