#include "surface/shape_builder.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace patina {

using Imath::V2d;
using Imath::V2f;
using Imath::V3d;
using Imath::V3f;

namespace {

constexpr double chartGap = 0.012;

struct Placement {
    V2d corner;
    bool turned = false;
};

/// Places rectangles, largest side first, each where its top comes to lie lowest on the outline of those already there
/// ("skyline"), upright or turned; empty where they do not fit into the unit square at this scale.
std::vector<Placement> placeCharts(const std::vector<V2d>& sizes, double scale) {
    std::vector<std::size_t> order(sizes.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto longSide = [&](std::size_t i) { return std::max(sizes[i].x, sizes[i].y); };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return longSide(a) > longSide(b); });

    struct Step {
        double left, right, height;
    };
    std::vector<Step> skyline = {{chartGap, 1.0, chartGap}};
    std::vector<Placement> placements(sizes.size());
    for (const std::size_t i : order) {
        double bestTop = 2.0, bestLeft = 0.0, bestBase = 0.0;
        bool bestTurned = false;
        for (const bool turned : {false, true}) {
            // Every chart brings the gap to its right and above along.
            const double width = (turned ? sizes[i].y : sizes[i].x) * scale + chartGap;
            const double height = (turned ? sizes[i].x : sizes[i].y) * scale + chartGap;
            for (const Step& start : skyline) {
                const double right = start.left + width;
                if (right > 1.0)
                    break;
                double base = 0.0;
                for (const Step& step : skyline)
                    if (step.right > start.left && step.left < right)
                        base = std::max(base, step.height);
                if (base + height < bestTop) {
                    bestTop = base + height;
                    bestLeft = start.left;
                    bestBase = base;
                    bestTurned = turned;
                }
            }
        }
        if (bestTop > 1.0)
            return {};
        placements[i] = {V2d(bestLeft, bestBase), bestTurned};
        const double right = bestLeft + (bestTurned ? sizes[i].y : sizes[i].x) * scale + chartGap;
        std::vector<Step> raised;
        for (const Step& step : skyline) {
            if (step.left < bestLeft)
                raised.push_back({step.left, std::min(step.right, bestLeft), step.height});
            if (step.left <= bestLeft && bestLeft < step.right)
                raised.push_back({bestLeft, right, bestTop});
            if (step.right > right)
                raised.push_back({std::max(step.left, right), step.right, step.height});
        }
        skyline = std::move(raised);
    }
    return placements;
}

} // namespace

VertexGrid::VertexGrid(int columnCount, int rowCount)
    : columns(columnCount), rows(rowCount),
      vertices(static_cast<std::size_t>(columnCount + 1) * static_cast<std::size_t>(rowCount + 1), -1) {}

V2d Sock::disc(int a, int b) const {
    const double x = 2.0 * a / across - 1.0;
    const double y = 2.0 * b / along - 1.0;
    return V2d(x * std::sqrt(1.0 - 0.5 * y * y), y * std::sqrt(1.0 - 0.5 * x * x));
}

V2d Sock::ring(int column) const {
    column %= columns();
    if (column < across)
        return disc(column, 0);
    column -= across;
    if (column < along)
        return disc(across, column);
    column -= along;
    if (column < across)
        return disc(across - column, along);
    column -= across;
    return disc(0, along - column);
}

ShapeBuilder::ShapeBuilder(std::string name) : name_(std::move(name)) {}

int ShapeBuilder::addVertex(const V3d& position) {
    positions_.push_back(position);
    return vertexCount() - 1;
}

void ShapeBuilder::addGrid(const VertexGrid& grid, double density) {
    std::vector<double> u(static_cast<std::size_t>(grid.columns) + 1, 0.0);
    std::vector<double> v(static_cast<std::size_t>(grid.rows) + 1, 0.0);
    for (int c = 0; c < grid.columns; ++c) {
        double sum = 0.0;
        for (int r = 0; r <= grid.rows; ++r)
            sum += (position(grid.at(c + 1, r)) - position(grid.at(c, r))).length();
        u[c + 1] = u[c] + sum / (grid.rows + 1);
    }
    for (int r = 0; r < grid.rows; ++r) {
        double sum = 0.0;
        for (int c = 0; c <= grid.columns; ++c)
            sum += (position(grid.at(c, r + 1)) - position(grid.at(c, r))).length();
        v[r + 1] = v[r] + sum / (grid.columns + 1);
    }

    Chart chart;
    chart.size = V2d(u.back(), v.back()) * density;
    for (int r = 0; r <= grid.rows; ++r)
        for (int c = 0; c <= grid.columns; ++c)
            chart.uvs.push_back(V2d(u[c], v[r]) * density);
    for (int r = 0; r < grid.rows; ++r)
        for (int c = 0; c < grid.columns; ++c) {
            chart.quads.push_back({grid.at(c, r), grid.at(c + 1, r), grid.at(c + 1, r + 1), grid.at(c, r + 1)});
            const int corner = r * (grid.columns + 1) + c;
            chart.quadUvs.push_back({corner, corner + 1, corner + grid.columns + 2, corner + grid.columns + 1});
        }
    charts_.push_back(std::move(chart));
}

void ShapeBuilder::addSock(const Sock& sock) {
    const int columns = sock.columns();
    VertexGrid side(columns, sock.rows);
    for (int r = 0; r <= sock.rows; ++r) {
        for (int c = 0; c < columns; ++c)
            side.at(c, r) = addVertex(sock.side(sock.ring(c), c, r));
        side.at(columns, r) = side.at(0, r);
    }

    int first = 0;
    std::vector<int> cuts = sock.chartRows;
    cuts.push_back(sock.rows);
    for (const int last : cuts) {
        VertexGrid part(columns, last - first);
        std::copy(side.vertices.begin() + static_cast<std::ptrdiff_t>(first) * (columns + 1),
                  side.vertices.begin() + static_cast<std::ptrdiff_t>(last + 1) * (columns + 1), part.vertices.begin());
        addGrid(part, sock.density);
        first = last;
    }

    for (const bool upper : {false, true}) {
        const int row = upper ? sock.rows : 0;
        VertexGrid patch(sock.across, sock.along);
        for (int b = 0; b <= sock.along; ++b)
            for (int a = 0; a <= sock.across; ++a) {
                int column = -1;
                if (b == 0)
                    column = a;
                else if (a == sock.across)
                    column = sock.across + b;
                else if (b == sock.along)
                    column = 2 * sock.across + sock.along - a;
                else if (a == 0)
                    column = columns - b;
                const V2d disc = sock.disc(a, b);
                // Seen from below, x runs to the left.
                patch.at(upper ? a : sock.across - a, b) =
                    column >= 0 ? side.at(column, row) : addVertex(upper ? sock.above(disc) : sock.below(disc));
            }
        addGrid(patch, sock.density);
    }
}

void ShapeBuilder::addBox(const std::array<int, 3>& quads, const std::function<V3d(const V3d&)>& position) {
    const auto [nx, ny, nz] = quads;
    // Vertices by their lattice place, so that the six sides share them.
    std::vector<int> lattice(static_cast<std::size_t>(nx + 1) * (ny + 1) * (nz + 1), -1);
    const auto vertexAt = [&, nx = nx, ny = ny, nz = nz](int i, int j, int k) {
        int& vertex = lattice[(static_cast<std::size_t>(k) * (ny + 1) + j) * (nx + 1) + i];
        if (vertex < 0)
            vertex = addVertex(position(V3d(2.0 * i / nx - 1.0, 2.0 * j / ny - 1.0, 2.0 * k / nz - 1.0)));
        return vertex;
    };
    const auto addSide = [&](int columns, int rows, auto&& place) {
        VertexGrid grid(columns, rows);
        for (int r = 0; r <= rows; ++r)
            for (int c = 0; c <= columns; ++c)
                grid.at(c, r) = place(c, r);
        addGrid(grid);
    };
    addSide(nx, nz, [&](int c, int r) { return vertexAt(c, 0, r); });
    addSide(ny, nz, [&, nx = nx](int c, int r) { return vertexAt(nx, c, r); });
    addSide(nx, nz, [&, nx = nx, ny = ny](int c, int r) { return vertexAt(nx - c, ny, r); });
    addSide(ny, nz, [&, ny = ny](int c, int r) { return vertexAt(0, ny - c, r); });
    addSide(nx, ny, [&, nz = nz](int c, int r) { return vertexAt(c, r, nz); });
    addSide(nx, ny, [&, nx = nx](int c, int r) { return vertexAt(nx - c, r, 0); });
}

void ShapeBuilder::interpolateLimit(int rounds) {
    const std::size_t count = positions_.size();
    const std::vector<V3d> targets = positions_;
    std::vector<int> valence(count, 0);
    for (const Chart& chart : charts_)
        for (const auto& quad : chart.quads)
            for (const int v : quad)
                ++valence[static_cast<std::size_t>(v)];
    std::vector<V3d> edges(count), diagonals(count);
    for (int round = 0; round < rounds; ++round) {
        std::fill(edges.begin(), edges.end(), V3d(0.0));
        std::fill(diagonals.begin(), diagonals.end(), V3d(0.0));
        for (const Chart& chart : charts_)
            for (const auto& quad : chart.quads)
                for (int k = 0; k < 4; ++k) {
                    const auto v = static_cast<std::size_t>(quad[k]);
                    // Each edge of a closed mesh is met twice: half of it here.
                    edges[v] += (position(quad[(k + 1) % 4]) + position(quad[(k + 3) % 4])) * 0.5;
                    diagonals[v] += position(quad[(k + 2) % 4]);
                }
        // The limit mask of Catmull-Clark at a vertex of valence n: n² itself, 4 each edge, 1 each diagonal, over n (n
        // + 5) (Halstead, Kass, DeRose 1993).
        for (std::size_t v = 0; v < count; ++v) {
            const double n = valence[v];
            if (n < 3.0)
                continue;
            const V3d limit = (positions_[v] * (n * n) + edges[v] * 4.0 + diagonals[v]) / (n * (n + 5.0));
            positions_[v] += targets[v] - limit;
        }
    }
}

Mesh ShapeBuilder::finish() const {
    std::vector<V2d> sizes;
    for (const Chart& chart : charts_)
        sizes.push_back(chart.size);
    // The largest scale at which everything fits, by bisection.
    double area = 0.0;
    for (const V2d& size : sizes)
        area += size.x * size.y;
    double fits = 0.0, tooLarge = 1.0 / std::sqrt(area);
    std::vector<Placement> placements;
    for (int step = 0; step < 40; ++step) {
        const double scale = 0.5 * (fits + tooLarge);
        std::vector<Placement> trial = placeCharts(sizes, scale);
        if (trial.empty()) {
            tooLarge = scale;
        } else {
            fits = scale;
            placements = std::move(trial);
        }
    }

    Mesh mesh;
    mesh.name = name_;
    for (const V3d& p : positions_)
        mesh.positions.emplace_back(V3f(p));
    for (std::size_t i = 0; i < charts_.size(); ++i) {
        const Chart& chart = charts_[i];
        const int firstUv = static_cast<int>(mesh.uvs.size());
        for (const V2d& uv : chart.uvs) {
            // A quarter turn keeps the chart from being mirrored.
            const V2d local = placements[i].turned ? V2d(chart.size.y - uv.y, uv.x) : uv;
            mesh.uvs.emplace_back(V2f(placements[i].corner + local * fits));
        }
        for (std::size_t q = 0; q < chart.quads.size(); ++q) {
            mesh.faceSizes.push_back(4);
            for (int k = 0; k < 4; ++k) {
                mesh.faceVertices.push_back(chart.quads[q][k]);
                mesh.faceUvs.push_back(firstUv + chart.quadUvs[q][k]);
            }
        }
    }
    return mesh;
}

} // namespace patina
