#pragma once
// The statuette's head as distance functions. Head space: millimetres, x to the viewer's right, y to the front, z up,
// origin in the middle of the skull at the height of the eyes. Chin at z = -23, topknot up to z = 36. Faces are alike
// left and right, so everything but the curls is made for x >= 0.

#include "surface/sculpting.h"

namespace patina::statuette {

using namespace sculpting;

/// Face, skull and hair with its curls, without the ears.
class Head {
  public:
    Head();
    double operator()(const V3d& p) const;

  private:
    double hairCap(const V3d& p) const; ///< skull and topknot under the curls
    double face(const V3d& p) const;
    double eye(const V3d& p) const;
    double curls(const V3d& p) const; ///< height above the hair cap

    void placeCurls();
    static int cell(double x, double y, double z);

    /// Curls' centres on the hair cap, by cells of space so that a point finds those near it.
    std::vector<std::vector<V3d>> curlCells_;
    Strand brow_, upperLip_, lowerLip_, mouthLine_;
};

/// Positive where hair grows: millimetres above the hairline, roughly. It runs level over the forehead, falls in front
/// of the ears and on behind them to the nape.
inline double aboveHairline(const V3d& p) {
    static constexpr double line[][2] = {{-24, -15.5}, {-14, -14}, {-6, -8},   {1, -1},
                                         {6, 5},       {10, 11},   {14, 14.2}, {24, 15.2}};
    double z = line[0][1];
    for (int i = 0; i < 7; ++i)
        z += (line[i + 1][1] - line[i][1]) * std::clamp((p.y - line[i][0]) / (line[i + 1][0] - line[i][0]), 0.0, 1.0);
    return p.z - z;
}

inline Head::Head()
    : brow_{{{1.3, 18.3, 4.3},
             {3.0, 18.3, 6.3},
             {5.6, 17.6, 7.6},
             {8.8, 15.9, 7.9},
             {12.3, 12.9, 6.7},
             {15.0, 9.2, 4.4}},
            {0.9, 1.0, 1.0, 0.95, 0.8, 0.5}},
      upperLip_{{{0, 19.4, -11.1}, {1.5, 19.6, -10.5}, {4.2, 18.3, -11.2}, {6.9, 16.2, -12.0}}, {1.0, 1.15, 0.95, 0.4}},
      lowerLip_{{{0, 19.0, -13.7}, {2.6, 18.6, -13.6}, {6.2, 16.5, -12.5}}, {1.5, 1.35, 0.45}},
      mouthLine_{{{0, 20.7, -12.25}, {1.5, 20.4, -12.0}, {4.0, 19.2, -12.15}, {7.4, 16.6, -12.0}},
                 {0.35, 0.35, 0.35, 0.3}} {
    placeCurls();
}

constexpr double curlSpacing = 4.1, curlRadius = 2.4;
constexpr double curlCell = 2 * curlRadius; // a curl reaches no farther than the next cell
constexpr int curlCellsAcross = 13, curlCellsUp = 14;

inline int Head::cell(double x, double y, double z) {
    const auto index = [](double t, int count) { return std::clamp(static_cast<int>(t / curlCell), 0, count - 1); };
    return (index(z + 24, curlCellsUp) * curlCellsAcross + index(y + 30, curlCellsAcross)) * curlCellsAcross +
           index(x + 30, curlCellsAcross);
}

/// Rings of curls at equal distances along the meridians from the crown down, each ring a half step on from the last.
inline void Head::placeCurls() {
    curlCells_.resize(curlCellsAcross * curlCellsAcross * curlCellsUp);
    const Body cap = [this](const V3d& p) { return hairCap(p); };
    constexpr int meridians = 48, steps = 120;
    constexpr double lowest = -0.9;
    std::vector<std::vector<V3d>> points(meridians, std::vector<V3d>(steps + 1));
    for (int m = 0; m < meridians; ++m)
        for (int i = 0; i <= steps; ++i) {
            const double azimuth = 2 * M_PI * m / meridians, e = mix(0.5 * M_PI, lowest, double(i) / steps);
            const V3d direction(std::sin(azimuth) * std::cos(e), std::cos(azimuth) * std::cos(e), std::sin(e));
            points[m][i] = outermost(cap, V3d(0.0), direction, 40.0, 1.0);
        }
    for (int row = 0; row < 20; ++row) {
        std::vector<V3d> ring;
        for (const auto& meridian : points) {
            double left = row * 0.9 * curlSpacing;
            std::size_t i = 0;
            for (; i + 2 < meridian.size(); ++i) {
                const double piece = (meridian[i + 1] - meridian[i]).length();
                if (left <= piece)
                    break;
                left -= piece;
            }
            const double piece = (meridian[i + 1] - meridian[i]).length();
            ring.push_back(mix(meridian[i], meridian[i + 1], std::min(1.0, left / piece)));
        }
        double length = 0.0;
        for (int m = 0; m < meridians; ++m)
            length += (ring[(m + 1) % meridians] - ring[m]).length();
        const int count = std::max(1, static_cast<int>(std::lround(length / curlSpacing)));
        double travelled = 0.0;
        int placed = 0;
        for (int m = 0; m < meridians && placed < count; ++m) {
            const V3d &a = ring[m], &b = ring[(m + 1) % meridians];
            const double piece = (b - a).length();
            for (double at; placed < count && (at = (placed + 0.5 * (row % 2)) * length / count) <= travelled + piece;
                 ++placed) {
                const V3d centre = mix(a, b, piece > 0 ? (at - travelled) / piece : 0.0);
                if (aboveHairline(centre) > 0.3)
                    curlCells_[cell(centre.x, centre.y, centre.z)].push_back(centre);
            }
            travelled += piece;
        }
    }
}

inline double Head::hairCap(const V3d& p) const {
    const double skull = ellipsoid(p, V3d(0, -2, 5), V3d(19.3, 21.3, 21.0));
    const double nape = ellipsoid(p, V3d(0, -7, -8), V3d(14, 14, 13));
    return join(join(skull, nape, 6), ellipsoid(p, V3d(0, -4.5, 24), V3d(11.5, 11.5, 11.5)), 2.5);
}

inline double Head::curls(const V3d& p) const {
    double height = 0.0;
    for (const double z : {p.z - curlRadius, p.z + curlRadius})
        for (const double y : {p.y - curlRadius, p.y + curlRadius})
            for (const double x : {p.x - curlRadius, p.x + curlRadius})
                for (const V3d& centre : curlCells_[cell(x, y, z)]) {
                    const double d = (p - centre).length2() / (curlRadius * curlRadius);
                    if (d < 1.0)
                        height = std::max(height, 1.9 * std::sqrt(1.0 - d));
                }
    return height;
}

/// Heavy lids over a nearly closed eye: a ball, with lids laid on it above and below the opening.
inline double Head::eye(const V3d& p) const {
    const double s = std::clamp((p.x - 2.9) / 10.2, 0.0, 1.0); // inner to outer corner
    const double arch = std::sin(M_PI * s);
    const double upper = -1.0 + 0.6 * s + 0.2 * arch; // edge of the upper lid
    const double lower = upper - 1.5 * arch;
    const double lids =
        0.95 * smoothstep(upper - 0.15, upper + 0.25, p.z) + 0.6 * smoothstep(lower + 0.15, lower - 0.25, p.z);
    return ellipsoid(p, V3d(7.7, 9.3, 0.4), V3d(6.6, 6.6, 4.6)) - lids;
}

inline double Head::face(const V3d& p) const {
    double d = ellipsoid(p, V3d(0, -2, 5), V3d(18.3, 20.3, 20));
    d = join(d, ellipsoid(p, V3d(0, 2.2, -6), V3d(16.8, 15.6, 16.6)), 6);
    if (p.y < 0.0 || d > 12.0)
        return p.y < 0.0 ? d : d - 8.0;                                       // no feature reaches farther out
    d = join(d, ellipsoid(p, V3d(8.6, 9.6, -8), V3d(7.6, 7.6, 8.6)), 6);      // cheek
    d = join(d, ellipsoid(p, V3d(0, 11.8, -11.8), V3d(8.5, 7.0, 6.5)), 4);    // muzzle
    d = join(d, ellipsoid(p, V3d(4.5, 9.0, -16.5), V3d(6.5, 6.0, 6.0)), 6);   // jaw
    d = join(d, ellipsoid(p, V3d(0, 13.2, -18.2), V3d(5.2, 4.6, 4.6)), 5);    // chin
    d = carve(d, ellipsoid(p, V3d(7.6, 19.0, 1.2), V3d(6.5, 4.6, 4.0)), 2.6); // socket
    d = join(d, eye(p), 0.6);
    d = join(d, brow_.distance(p), 1.8);

    d = join(d, limb(p, V3d(0, 17.3, 6), V3d(0, 21.6, -4.4), 1.5, 2.2), 2.2); // bridge
    d = join(d, ellipsoid(p, V3d(0, 22.2, -5.2), V3d(2.6, 2.5, 2.3)), 1.2);   // tip
    d = join(d, ellipsoid(p, V3d(2.6, 16.6, -2.4), V3d(2.0, 2.0, 3.0)), 2.5); // flank
    d = join(d, ellipsoid(p, V3d(3.0, 19.4, -5.9), V3d(2.1, 2.7, 1.9)), 1.4); // wing
    d = carve(d, ellipsoid(p, V3d(1.6, 21.4, -8.0), V3d(0.9, 1.6, 1.1)), 0.6);

    d = join(d, upperLip_.distance(p), 0.9);
    d = join(d, lowerLip_.distance(p), 0.9);
    d = carve(d, mouthLine_.distance(p), 0.55);
    d = carve(d, limb(p, V3d(0, 20.6, -8.4), V3d(0, 20.9, -9.6), 0.6, 0.6), 0.9);
    d = carve(d, limb(p, V3d(0, 19.6, -16.6), V3d(4, 18.5, -16.2), 1.0, 0.8), 2.0);
    // The mark between the brows.
    return join(d, sphere(p, V3d(0, 18.1, 8.8), 1.6), 1.0);
}

inline double Head::operator()(const V3d& p) const {
    const double above = aboveHairline(p);
    const double cap = hairCap(p);
    // The cap runs out in a slope at the hairline; its curls stand on it.
    double hair = std::max(cap, -0.55 * above);
    if (cap < 3.0 && above > -1.0)
        hair = std::max(cap - curls(p) * smoothstep(-1.0, 0.8, above), -0.55 * above - 1.0);
    else if (cap > 6.0 && p.y < -4.0)
        return cap - 2.0;
    return join(face(V3d(std::abs(p.x), p.y, p.z)), hair, 0.4);
}

/// An ear as a relief on its own plane: forward and up in it, origin at the ear's hole, millimetres.
/// Distance to its outline, negative inside: a shell above, a long lobe below.
inline double earOutline(double forward, double up) {
    const V3d q(forward, up, 0);
    return join(ellipsoid(q, V3d(-1.2, 4, 0), V3d(5.4, 8.2, 8)), ellipsoid(q, V3d(0.4, -8.5, 0), V3d(3.4, 7.2, 8)),
                3.0);
}

/// Height above the plane: a rim around the shell, the bowl at the hole, a fold between them, a slit lobe.
inline double earRelief(double forward, double up) {
    const double inward = -earOutline(forward, up);
    double h = 1.4 * std::sqrt(std::clamp(inward / 1.2, 0.0, 1.0));
    h += 1.1 * bump(inward - 1.0, 1.1) * smoothstep(-6, -1, up);
    const V3d q(forward, up, 0);
    h -= 2.2 * smoothstep(0.8, -1.2, ellipsoid(q, V3d(0.6, 1.2, 0), V3d(2.4, 3.8, 8)));
    h += 0.8 * bump(ellipsoid(q, V3d(0.6, 1.6, 0), V3d(3.1, 4.8, 8)), 0.9) * smoothstep(2.0, 0.0, forward);
    h += 1.0 * bump((q - V3d(3.0, 0.4, 0)).length(), 1.6); // tragus
    h -= 1.3 * smoothstep(0.5, -0.6, ellipsoid(q, V3d(0.5, -9.5, 0), V3d(0.9, 3.6, 8)));
    return h;
}

} // namespace patina::statuette
