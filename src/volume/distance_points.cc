#include "volume/distance_points.h"

#include <tbb/parallel_for.h>

namespace patina {

// Axis by axis, along every line of blocks.
void widenMarks(BlockBox& marks, int reach) {
    const openvdb::Coord size = marks.box().dim();
    const int step[3] = {size.y() * size.z(), size.z(), 1};
    for (int axis = 0; axis < 3; ++axis) {
        const int length = size[axis], stride = step[axis];
        const auto lines = static_cast<int>(marks.numbers().size()) / length;
        tbb::parallel_for(0, lines, [&](int line) {
            const int start = axis == 0   ? line
                              : axis == 1 ? line / stride * stride * length + line % stride
                                          : line * length;
            std::int32_t* cells = marks.numbers().data() + start;
            std::vector<int> next(length + 1, length + reach + 1); // the next marked one at or behind each
            for (int i = length - 1; i >= 0; --i)
                next[i] = cells[i * stride] >= 0 ? i : next[i + 1];
            int last = -reach - 1;
            for (int i = 0; i < length; ++i) {
                if (next[i] == i)
                    last = i;
                cells[i * stride] = i - last <= reach || next[i] - i <= reach ? 0 : -1;
            }
        });
    }
}

} // namespace patina
