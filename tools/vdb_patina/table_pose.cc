#include "table_pose.h"

#include <algorithm>

namespace patina::tool {

void Turn::apply(SurfaceMesh& surface) const {
    const auto turn = [this](Imath::V3f& v) { v = (*this)(v); };
    std::for_each(surface.positions.begin(), surface.positions.end(), turn);
    std::for_each(surface.normals.begin(), surface.normals.end(), turn);
}

Turn poseOnTable(const SurfaceMesh& surface, UpAxis up) {
    Turn turn;
    Imath::V3d area(0.0);
    double total = 0.0;
    for (const Imath::V3i& t : surface.triangles) {
        const Imath::V3d a(surface.positions[t[0]]);
        const Imath::V3d cross =
            (Imath::V3d(surface.positions[t[1]]) - a).cross(Imath::V3d(surface.positions[t[2]]) - a);
        area += cross;
        total += cross.length();
    }
    if (!(area.length() > 0.1 * total))
        return turn;
    const Frame set = uprightFrame(up);
    const auto axes = [](const Imath::V3d& normal, const Imath::V3d& upward) {
        std::array<Imath::V3d, 3> frame;
        frame[0] = normal.normalized();
        Imath::V3d side = upward.cross(frame[0]);
        if (side.length() < 1e-3)
            side = Imath::V3d(upward.y, upward.z, upward.x).cross(frame[0]);
        frame[1] = side.normalized();
        frame[2] = frame[0].cross(frame[1]);
        return frame;
    };
    const Imath::V3d upward(set.normal), front(-set.bitangent);
    const auto from = axes(area, upward), to = axes(front + upward, upward);
    for (int row = 0; row < 3; ++row)
        turn.rows[row] = from[0] * to[0][row] + from[1] * to[1][row] + from[2] * to[2][row];
    return turn;
}

} // namespace patina::tool
