#pragma once
// How a close-up lies in its picture.

#include "render/frame.h"
#include "surface/mesh.h"

#include <array>

namespace patina::tool {

/// A rotation: three rows.
struct Turn {
    std::array<Imath::V3d, 3> rows{Imath::V3d(1, 0, 0), Imath::V3d(0, 1, 0), Imath::V3d(0, 0, 1)};

    Imath::V3f operator()(const Imath::V3f& v) const {
        const Imath::V3d w(v);
        return Imath::V3f(Imath::V3d(rows[0].dot(w), rows[1].dot(w), rows[2].dot(w)));
    }
    /// The other way round.
    Imath::V3f back(const Imath::V3f& v) const {
        return Imath::V3f(rows[0] * double(v.x) + rows[1] * double(v.y) + rows[2] * double(v.z));
    }
    void apply(SurfaceMesh& surface) const; ///< to positions and normals
};

/// A close-up lies on the photographer's table, wherever on the model it was cut out: its mean normal half way between
/// the front and up. Where it looks all ways it stays as it is.
Turn poseOnTable(const SurfaceMesh& surface, UpAxis up);

} // namespace patina::tool
