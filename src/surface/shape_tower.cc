// An octagonal turret: window bays with louvres between pilasters, a cornice with dentils, a bell-shaped dome of sheet
// metal with ribs and standing seams, a lantern with a smaller dome of its own, and a finial. Metres.

#include "surface/shape_builder.h"
#include "surface/shape_makers.h"

#include <algorithm>
#include <cmath>

namespace patina {

using Imath::V2d;
using Imath::V3d;

namespace {

constexpr int bayCount = 8;
const double halfBay = std::tan(M_PI / bayCount); // half a side of an octagon, per apothem

/// A point of the wall: `apothem` from the axis to the bay's plane, `across` the bay from -1 (left corner) to 1,
/// height.
struct WallPoint {
    double apothem, across, z;
};

/// One row of quads' vertices around the tower: the same in every bay.
using Row = std::vector<WallPoint>; // columns + 1 of them

double bump(double x, double width) {
    const double t = std::min(1.0, std::abs(x) / width);
    return (1.0 - t * t) * (1.0 - t * t);
}

/// Where the columns stand in a plain row: close together around the edge of the corner pilaster.
std::vector<double> plainColumns(int columns, double pilaster) {
    std::vector<double> across(static_cast<std::size_t>(columns) + 1);
    for (int j = 0; j <= columns / 2; ++j) {
        const double t = double(j - 3) / (columns / 2 - 3);
        const double at = j == 0   ? -1.0
                          : j == 1 ? -1.0 + 0.5 * pilaster
                          : j == 2 ? -1.0 + pilaster
                                   : -1.0 + pilaster + 0.03 + (1.0 - pilaster - 0.03) * t;
        across[j] = at;
        across[columns - j] = -at;
    }
    return across;
}

/// Rows along a profile of (apothem, z) with corners: each corner gets a row close by on either side, long pieces are
/// divided.
void addProfile(std::vector<Row>& rows, const std::vector<V2d>& corners, const std::vector<double>& columns,
                double longest) {
    std::vector<V2d> points = {corners.front()};
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
        const V2d a = corners[i], b = corners[i + 1];
        const double length = (b - a).length();
        const double support = std::min(0.008, 0.25 * length) / length;
        const int parts = std::max(1, static_cast<int>(std::lround(length / longest)));
        points.push_back(a + (b - a) * support);
        for (int k = 1; k < parts; ++k)
            points.push_back(a + (b - a) * (double(k) / parts));
        points.push_back(a + (b - a) * (1.0 - support));
        points.push_back(b);
    }
    for (const V2d& p : points) {
        Row row;
        for (const double across : columns)
            row.push_back({p.x, across, p.y});
        rows.push_back(row);
    }
}

/// An arched window with louvres, framed by a moulding, between two pilasters.
struct Bay {
    int columns;               ///< of quads
    double apothem;            ///< of the wall
    double bottom, top;        ///< of the bay
    double sill, spring;       ///< heights of the window's foot and of the arch's beginning
    double halfWidth;          ///< of the window, also the arch's radius
    double pilaster;           ///< width of half a pilaster, as a share of half the bay
    double depth;              ///< of the window's reveal
    double relief;             ///< of pilasters and moulding
    int rows, sillRow, topRow; ///< rows of quads; the lines at the window's foot and crown
    int halfColumns;           ///< columns from the window's middle to its jamb
};

/// The window's opening is a rectangle of the grid whose upper corners lie on the arch, 45° up; loops around and inside
/// it make moulding and reveal; the wall between them and the bay's border is relaxed.
void addBay(std::vector<Row>& rows, const Bay& bay) {
    const int n = bay.columns, m = bay.rows, middle = n / 2;
    const double half = bay.apothem * halfBay;
    const std::vector<double> plain = plainColumns(n, bay.pilaster);
    struct Vertex {
        double s, z, depth = 0.0;
        bool fixed = false;
    };
    std::vector<std::vector<Vertex>> grid(m + 1, std::vector<Vertex>(n + 1));
    const double edge = 0.012 * (bay.top - bay.bottom);
    for (int k = 0; k <= m; ++k) {
        const double t = std::clamp((k - 2.0) / (m - 4.0), 0.0, 1.0);
        const double z = k == 0       ? bay.bottom
                         : k == 1     ? bay.bottom + edge
                         : k == m     ? bay.top
                         : k == m - 1 ? bay.top - edge
                                      : bay.bottom + 2 * edge + (bay.top - bay.bottom - 4 * edge) * t;
        for (int j = 0; j <= n; ++j) {
            Vertex& v = grid[k][j];
            const int fromCorner = std::min(j, n - j);
            v = {plain[j] * half, z, 0.0, k <= 1 || k >= m - 1 || fromCorner <= 3};
            if (fromCorner <= 2 && k >= 1 && k <= m - 1)
                v.depth = -bay.relief;
        }
    }

    struct Loop {
        int outward;
        double offset, depth;
    };
    const double frame = 0.2 * bay.halfWidth;
    for (const Loop& loop :
         {Loop{2, 1.2 * frame, 0.0}, Loop{1, frame, -0.7 * bay.relief}, Loop{0, 0.0, -0.7 * bay.relief},
          Loop{-1, -0.12 * frame, 0.85 * bay.depth}, Loop{-2, -0.7 * frame, bay.depth}}) {
        const int reach = bay.halfColumns + loop.outward;
        const int below = bay.sillRow - loop.outward, above = bay.topRow + loop.outward;
        const double w = bay.halfWidth + loop.offset, foot = bay.sill - loop.offset;
        const double jamb = bay.spring - foot, arc = w * M_PI / 4;
        const auto place = [&](int j, int k, double s, double z) { grid[k][j] = {s, z, loop.depth, true}; };
        for (int k = below; k <= above; ++k) {
            const double at = (jamb + arc) * (k - below) / (above - below);
            const double angle = std::max(0.0, (at - jamb) / w);
            const double s = at < jamb ? w : w * std::cos(angle);
            const double z = at < jamb ? foot + at : bay.spring + w * std::sin(angle);
            place(middle - reach, k, -s, z);
            place(middle + reach, k, s, z);
        }
        for (int j = -reach + 1; j < reach; ++j) {
            const double angle = M_PI / 2 - M_PI / 4 * j / reach;
            place(middle + j, above, w * std::cos(angle), bay.spring + w * std::sin(angle));
            place(middle + j, below, w * j / reach, foot);
        }
    }
    for (int pass = 0; pass < 400; ++pass)
        for (int k = 1; k < m; ++k)
            for (int j = 1; j < n; ++j)
                if (Vertex& v = grid[k][j]; !v.fixed) {
                    v.s = 0.25 * (grid[k - 1][j].s + grid[k + 1][j].s + grid[k][j - 1].s + grid[k][j + 1].s);
                    v.z = 0.25 * (grid[k - 1][j].z + grid[k + 1][j].z + grid[k][j - 1].z + grid[k][j + 1].z);
                }
    for (int k = bay.sillRow + 3; k <= bay.topRow - 3; ++k) // louvres: every other row stands out
        for (int j = middle - bay.halfColumns + 3; j <= middle + bay.halfColumns - 3; ++j)
            grid[k][j].depth = bay.depth * (k % 2 ? 1.15 : 0.60);

    for (const auto& line : grid) {
        Row row;
        for (const Vertex& v : line)
            row.push_back({bay.apothem - v.depth, v.s / half, v.z});
        rows.push_back(row);
    }
}

/// A bell-shaped roof of eight sheets: ribs over the corners, standing seams between.
struct Dome {
    int columns, rows;
    double bottom, top;         ///< heights
    double eaves, belly, crown; ///< apothems at the foot, where widest beyond the straight line, at the top
    double rib, seam;           ///< how far they stand out
};

void addDome(std::vector<Row>& rows, const Dome& dome) {
    const int n = dome.columns;
    // Columns gather at two seams in each sheet.
    std::vector<double> across = plainColumns(n, 0.13);
    const int seamColumn = n == 20 ? 8 : 6;
    const double seamAt = 0.31;
    for (const int sign : {-1, 1})
        for (int d = -1; d <= 1; ++d) {
            const int j = sign < 0 ? seamColumn + d : n - seamColumn + d;
            across[j] = sign * seamAt + 0.028 * d;
        }
    // The rest of the columns spread evenly between corner, seams and middle.
    const auto spread = [&](int from, int to) {
        for (int j = from + 1; j < to; ++j)
            across[j] = across[from] + (across[to] - across[from]) * (j - from) / (to - from);
    };
    spread(3, seamColumn - 1);
    spread(seamColumn + 1, n - seamColumn - 1);
    spread(n - seamColumn + 1, n - 3);

    for (int k = 0; k <= dome.rows; ++k) {
        const double t = double(k) / dome.rows;
        // A flare at the eaves, a round shoulder, a hollow neck.
        const double shoulder = std::cos(0.5 * M_PI * std::pow(t, 1.25));
        const double a =
            dome.crown + (dome.eaves - dome.crown) * shoulder + dome.belly * bump(t - 0.30, 0.30) * (1.0 - t);
        const double z = dome.bottom + (dome.top - dome.bottom) * (0.25 * t + 0.75 * std::sin(0.5 * M_PI * t));
        const double ends = std::min(1.0, std::min(t, 1.0 - t) * 14.0);
        Row row;
        for (int j = 0; j <= n; ++j) {
            const int fromCorner = std::min(j, n - j);
            double out = fromCorner <= 1 ? dome.rib : fromCorner == 2 ? 0.8 * dome.rib : 0.0;
            if (j == seamColumn || j == n - seamColumn)
                out = dome.seam;
            row.push_back({a + out * ends, across[j], z});
        }
        rows.push_back(row);
    }
}

/// Stands every other pair of columns of the rows in [from, to) out.
void addDentils(std::vector<Row>& rows, std::size_t from, std::size_t to, double out) {
    for (std::size_t k = from; k < to; ++k)
        for (std::size_t j = 0; j < rows[k].size(); ++j)
            if (j % 4 < 2 && j > 1 && j + 2 < rows[k].size())
                rows[k][j].apothem += out;
}

/// A stack of rows as one closed sock, charts cut at `chartRows`.
void addStack(ShapeBuilder& builder, const std::vector<Row>& rows, std::vector<int> chartRows) {
    const int perBay = static_cast<int>(rows.front().size()) - 1;
    Sock sock;
    sock.across = sock.along = bayCount * perBay / 4;
    sock.rows = static_cast<int>(rows.size()) - 1;
    sock.chartRows = std::move(chartRows);
    sock.side = [&](V2d, int column, int row) {
        // The sock's first column looks along -135°, the middle of a bay; a bay looks along -90°.
        const int place = column + perBay / 2;
        const int bay = place / perBay - 1;
        const WallPoint& p = rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(place % perBay)];
        const double angle = -0.5 * M_PI + 2 * M_PI * bay / bayCount;
        const V3d outward(std::cos(angle), std::sin(angle), 0.0), right(-std::sin(angle), std::cos(angle), 0.0);
        return outward * p.apothem + right * (p.across * p.apothem * halfBay) + V3d(0, 0, p.z);
    };
    const auto patch = [](const V2d& disc, const Row& row) {
        const double side = 2 * M_PI / bayCount;
        const double angle = std::atan2(disc.y, disc.x);
        const double inBay = std::remainder(angle + 0.5 * M_PI, side);
        const double r = disc.length() * row.front().apothem / std::cos(inBay);
        return V3d(r * std::cos(angle), r * std::sin(angle), row.front().z);
    };
    sock.below = [&](V2d disc) { return patch(disc, rows.front()); };
    sock.above = [&](V2d disc) { return patch(disc, rows.back()); };
    builder.addSock(sock);
}

void addBody(ShapeBuilder& builder) {
    constexpr int columns = 20;
    const std::vector<double> plain = plainColumns(columns, 0.22);
    std::vector<Row> rows;
    std::vector<int> charts;
    const auto cut = [&] { charts.push_back(static_cast<int>(rows.size()) - 1); };
    addProfile(rows, {{1.14, 0.0}, {1.14, 0.34}, {1.10, 0.40}, {1.06, 0.40}, {1.06, 0.58}, {1.00, 0.64}, {1.0, 0.66}},
               plain, 0.09);
    cut();
    addBay(rows, {columns, 0.95, 0.67, 2.42, 0.92, 1.78, 0.20, 0.22, 0.16, 0.036, 40, 7, 32, 4});
    cut();
    addProfile(rows, {{1.0, 2.43}, {1.0, 2.50}, {1.02, 2.51}, {1.02, 2.54}, {0.97, 2.55}, {0.97, 2.595}}, plain, 0.09);
    const std::size_t dentils = rows.size();
    addProfile(rows, {{0.98, 2.60}, {0.98, 2.69}}, plain, 0.03);
    addDentils(rows, dentils + 1, rows.size() - 1, 0.075);
    addProfile(rows,
               {{1.00, 2.695},
                {1.08, 2.70},
                {1.09, 2.73},
                {1.16, 2.76},
                {1.17, 2.83},
                {1.20, 2.87},
                {1.20, 2.90},
                {1.03, 2.94},
                {1.0, 3.02}},
               plain, 0.09);
    cut();
    addDome(rows, {columns, 34, 3.03, 4.36, 1.06, 0.10, 0.40, 0.040, 0.045});
    cut();
    addProfile(rows, {{0.40, 4.37}, {0.44, 4.39}, {0.44, 4.44}, {0.38, 4.46}}, plain, 0.09);
    addStack(builder, rows, charts);
}

void addLantern(ShapeBuilder& builder) {
    constexpr int columns = 16;
    const std::vector<double> plain = plainColumns(columns, 0.26);
    std::vector<Row> rows;
    std::vector<int> charts;
    const auto cut = [&] { charts.push_back(static_cast<int>(rows.size()) - 1); };
    addProfile(rows, {{0.345, 4.42}, {0.345, 4.50}, {0.325, 4.53}}, plain, 0.06);
    cut();
    addBay(rows, {columns, 0.30, 4.535, 5.06, 4.60, 4.87, 0.058, 0.26, 0.05, 0.014, 28, 5, 23, 3});
    cut();
    addProfile(rows,
               {{0.32, 5.07},
                {0.32, 5.09},
                {0.345, 5.105},
                {0.375, 5.125},
                {0.38, 5.15},
                {0.39, 5.165},
                {0.39, 5.175},
                {0.335, 5.19}},
               plain, 0.06);
    cut();
    addDome(rows, {columns, 22, 5.20, 5.62, 0.335, 0.075, 0.075, 0.014, 0.014});
    addStack(builder, rows, charts);
}

/// Turned on a lathe: a knob, a ball, a spike.
void addFinial(ShapeBuilder& builder) {
    std::vector<V2d> profile = {{0.05, 5.57},  {0.07, 5.60}, {0.105, 5.615}, {0.11, 5.63},
                                {0.10, 5.648}, {0.06, 5.66}, {0.045, 5.69}};
    for (int i = 1; i < 14; ++i) { // the ball
        const double angle = -M_PI / 2 + M_PI * i / 14;
        profile.push_back({std::max(0.04, 0.10 * std::cos(angle)), 5.79 + 0.10 * std::sin(angle)});
    }
    for (const V2d& p : {V2d(0.04, 5.895), V2d(0.055, 5.91), V2d(0.055, 5.925), V2d(0.03, 5.94), V2d(0.026, 5.98),
                         V2d(0.022, 6.06), V2d(0.017, 6.14), V2d(0.011, 6.22), V2d(0.006, 6.29), V2d(0.003, 6.30)})
        profile.push_back(p);
    Sock sock;
    sock.across = sock.along = 6;
    sock.rows = static_cast<int>(profile.size()) - 1;
    sock.side = [&](V2d ring, int, int row) {
        return V3d(ring.x * profile[row].x, ring.y * profile[row].x, profile[row].y);
    };
    sock.below = [&](V2d disc) {
        return V3d(disc.x * profile.front().x, disc.y * profile.front().x, profile.front().y);
    };
    sock.above = [&](V2d disc) { return V3d(disc.x * profile.back().x, disc.y * profile.back().x, profile.back().y); };
    builder.addSock(sock);
}

} // namespace

Mesh makeTower() {
    ShapeBuilder builder("tower");
    addBody(builder);
    addLantern(builder);
    addFinial(builder);
    return builder.finish();
}

} // namespace patina
