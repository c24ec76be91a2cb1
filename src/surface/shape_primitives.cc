// The shapes of few lines: plate, strip, sphere, groove.

#include "surface/shape_builder.h"
#include "surface/shape_makers.h"

#include <algorithm>
#include <cmath>

namespace patina {

using Imath::V3d;

namespace {

/// A sheet on z = 0, centred on the origin.
Mesh makeSheet(const char* name, double width, double depth, int columns, int rows) {
    ShapeBuilder builder(name);
    VertexGrid grid(columns, rows);
    for (int r = 0; r <= rows; ++r)
        for (int c = 0; c <= columns; ++c)
            grid.at(c, r) =
                builder.addVertex(V3d((double(c) / columns - 0.5) * width, (double(r) / rows - 0.5) * depth, 0));
    builder.addGrid(grid);
    return builder.finish();
}

/// A groove across the block's top: metres.
struct Groove {
    double width;
    bool vShaped; ///< else a slot with upright walls
};

} // namespace

Mesh makePlate() {
    return makeSheet("plate", 0.1, 0.1, 40, 40);
}

Mesh makeStrip() {
    return makeSheet("strip", 0.3, 0.1, 90, 30);
}

Mesh makeSphere() {
    constexpr double radius = 0.05;
    constexpr int quads = 24;
    ShapeBuilder builder("sphere");
    builder.addBox({quads, quads, quads}, [](const V3d& p) {
        // Equal angles instead of equal lengths on the cube: quads of nearly one size.
        const auto spread = [](double t) { return std::tan(t * M_PI / 4); };
        return V3d(0, 0, radius) + V3d(spread(p.x), spread(p.y), spread(p.z)).normalized() * radius;
    });
    builder.interpolateLimit(6); // it is the limit surface that has this radius
    return builder.finish();
}

Mesh makeGroove() {
    constexpr double width = 0.12, depth = 0.06, height = 0.02, grooveDepth = 0.01;
    constexpr double support = 0.00025; // loops this close to an edge keep it crisp when subdivided
    constexpr double pitch = 0.0018;
    const std::vector<Groove> grooves = {{0.0005, false}, {0.001, false}, {0.002, false}, {0.004, false},
                                         {0.008, false},  {0.016, false}, {0.002, true},  {0.004, true},
                                         {0.008, true},   {0.016, true}};

    // The block is its profile drawn out along y. A column of quads starts at a point of the profile and ends on
    // the bottom, straight below where it can: `foot` keeps columns that share a place (upright walls) apart.
    struct Column {
        double place, depth, foot;
    };
    std::vector<Column> columns;
    std::size_t landStart = 0; // first column whose foot stands under the land between two grooves
    const auto add = [&](double place, double columnDepth) { columns.push_back({place, columnDepth, place}); };
    const auto addSpan = [&](double to, double lineDepth) { // lines between the last one and `to`, where there is room
        const double from = columns.back().place;
        const int parts = std::max(1, static_cast<int>(std::lround((to - from) / pitch)));
        for (int i = 1; i < parts; ++i)
            add(from + (to - from) * i / parts, lineDepth);
    };
    const auto spreadLandFeet = [&](double from, double to) {
        const double count = static_cast<double>(columns.size() - landStart) - 1.0;
        for (std::size_t i = landStart; i < columns.size(); ++i)
            columns[i].foot = from + (to - from) * static_cast<double>(i - landStart) / count;
    };

    double used = 0.0;
    for (const Groove& groove : grooves)
        used += groove.width;
    const double land = (width - used) / (static_cast<double>(grooves.size()) + 1.0);
    double landLeft = -0.5 * width;
    add(landLeft, 0.0);
    for (const Groove& groove : grooves) {
        const double left = landLeft + land, right = left + groove.width;
        const double edge = std::min(support, groove.width / 6);
        add(landLeft + support, 0.0);
        addSpan(left - support, 0.0);
        add(left - support, 0.0);
        add(left, 0.0);
        if (groove.vShaped) {
            spreadLandFeet(landLeft, left);
            const double deepest = std::min(grooveDepth, groove.width);
            for (const double t : {0.05, 0.25, 0.45, 0.5, 0.55, 0.75, 0.95})
                add(left + t * groove.width, deepest * (1.0 - std::abs(2.0 * t - 1.0)));
            landStart = columns.size();
        } else {
            for (const double t : {0.03, 0.35, 0.65, 0.97, 1.0})
                add(left, t * grooveDepth);
            spreadLandFeet(landLeft, left);
            add(left + edge, grooveDepth);
            addSpan(right - edge, grooveDepth);
            add(right - edge, grooveDepth);
            landStart = columns.size();
            for (const double t : {1.0, 0.97, 0.65, 0.35, 0.03})
                add(right, t * grooveDepth);
        }
        add(right, 0.0);
        landLeft = right;
    }
    add(landLeft + support, 0.0);
    addSpan(0.5 * width - support, 0.0);
    add(0.5 * width - support, 0.0);
    add(0.5 * width, 0.0);
    spreadLandFeet(landLeft, 0.5 * width);

    std::vector<double> rows = {-0.5 * depth};
    constexpr int rowCount = 24;
    for (int i = 0; i <= rowCount; ++i)
        rows.push_back((0.5 * depth - support) * (2.0 * i / rowCount - 1.0));
    rows.push_back(0.5 * depth);
    const std::vector<double> levels = {0.0, 0.02, 0.25, 0.5, 0.75, 0.98, 1.0}; // from bottom to top

    ShapeBuilder builder("groove");
    const std::array<int, 3> quads = {static_cast<int>(columns.size()) - 1, static_cast<int>(rows.size()) - 1,
                                      static_cast<int>(levels.size()) - 1};
    builder.addBox(quads, [&](const V3d& p) {
        const auto index = [](double t, int count) {
            return static_cast<std::size_t>(std::lround((t + 1.0) / 2.0 * count));
        };
        const Column& column = columns[index(p.x, quads[0])];
        const double t = levels[index(p.z, quads[2])];
        return V3d(column.foot + (column.place - column.foot) * t, rows[index(p.y, quads[1])],
                   (height - column.depth) * t);
    });
    return builder.finish();
}

} // namespace patina
