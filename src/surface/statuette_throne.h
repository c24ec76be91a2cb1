#pragma once
// The lotus throne: a profile drawn around an ellipse, with two wreaths of petals in relief. Millimetres, z up from the
// ground.

#include "surface/sculpting.h"

#include <array>

namespace patina::statuette {

using namespace sculpting;

inline constexpr int petalCount = 16;
inline constexpr int columnsPerPetal = 10;

class Throne {
  public:
    explicit Throne(double height);

    int rows() const { return static_cast<int>(profile_.size()) - 1; }

    /// Columns count counter-clockwise from the front's left corner, an eighth of the girth from the front's middle.
    V3d at(int column, int row) const;

    /// Inside the top (row = rows()) or the bottom (row = 0): `share` of the way from the middle to the edge, `turn` as
    /// a share of the girth.
    V3d inside(double turn, double share, int row) const;

  private:
    enum class Wreath { none, upper, lower };
    struct Level {
        double out, z; ///< millimetres outside the throne's ellipse, and up
        Wreath wreath = Wreath::none;
        double along = 0.0;  ///< from a petal's root to its tip
        double gather = 0.0; ///< share in which columns still keep together as at the petals' tips, beside a wreath
    };
    struct PetalPoint {
        double turn, relief;
    };
    static PetalPoint petal(int column, double along);
    double angle(double turn) const;

    static constexpr double width_ = 83, depth_ = 53;
    std::vector<Level> profile_;
    std::vector<double> angles_; ///< at equal steps of the girth
};

inline Throne::Throne(double height) {
    const auto add = [&](double out, double z, double gather = 0.0) {
        profile_.push_back({out, z, Wreath::none, 1.0, gather});
    };
    for (const auto& [out, z] : std::initializer_list<std::pair<double, double>>{
             {7.0, 0}, {8.6, 0.2}, {9.0, 0.8}, {9.0, 3.0}, {9.0, 5.4}, {8.6, 6.1}, {7.2, 6.4}, {6.0, 6.6}, {5.4, 7.2}})
        add(out, z);
    add(4.6, 8.0, 0.35);
    add(3.2, 8.8, 0.7);
    add(1.6, 9.4, 0.95);
    constexpr int steps = 14;
    for (int i = 0; i <= steps; ++i) { // hanging petals, tips first
        const double t = 1.0 - double(i) / steps;
        profile_.push_back({-8.5 + 9.0 * std::sin(0.5 * M_PI * std::pow(t, 0.9)), 25.0 - 15.0 * t, Wreath::lower, t});
    }
    for (const auto& [out, z] : std::initializer_list<std::pair<double, double>>{
             {-8.6, 25.6}, {-6.6, 25.9}, {-5.4, 26.8}, {-5.4, 28.0}, {-6.6, 28.9}, {-8.6, 29.2}})
        add(out, z);
    for (int i = 0; i <= steps + 2; ++i) { // standing petals
        const double t = double(i) / (steps + 2);
        profile_.push_back(
            {-8.5 + 6.0 * std::sin(0.5 * M_PI * std::pow(t, 0.7)), 30.0 + (height - 35.0) * t, Wreath::upper, t});
    }
    const double top = height;
    add(-2.0, top - 5.2, 0.95);
    add(-3.4, top - 4.9, 0.7);
    add(-3.9, top - 4.3, 0.35);
    for (const auto& [out, z] : std::initializer_list<std::pair<double, double>>{
             {-3.4, top - 3.5}, {-2.6, top - 2.4}, {-2.6, top - 1.2}, {-3.2, top - 0.3}, {-4.6, top}})
        add(out, z);

    // Equal steps along the girth of the ellipse, from the front's left corner.
    constexpr int samples = 4096;
    std::vector<double> length(samples + 1, 0.0);
    const auto speed = [](double a) { return std::hypot(width_ * std::sin(a), depth_ * std::cos(a)); };
    for (int i = 0; i < samples; ++i)
        length[i + 1] = length[i] + speed(2 * M_PI * (i + 0.5) / samples);
    constexpr int stepsAround = 16 * petalCount * columnsPerPetal / 4;
    const auto angleAtLength = [&](double wanted) {
        const auto next = std::upper_bound(length.begin(), length.end(), wanted) - length.begin();
        const auto i = std::clamp<std::ptrdiff_t>(next - 1, 0, samples - 1);
        return 2 * M_PI * (double(i) + (wanted - length[i]) / (length[i + 1] - length[i])) / samples;
    };
    for (int i = 0; i <= stepsAround; ++i) {
        // The front's middle is at angle -90°, three quarters of the girth from angle 0.
        const double share = 0.75 - 0.125 + double(i) / stepsAround;
        angles_.push_back(angleAtLength((share - std::floor(share)) * length.back()) + 2 * M_PI * std::floor(share));
    }
}

inline double Throne::angle(double turn) const {
    const double at = (turn - std::floor(turn)) * double(angles_.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(at), angles_.size() - 2);
    return mix(angles_[i], angles_[i + 1], at - double(i));
}

/// A wreath of petals. Of a petal's columns seven share its width at every height, so that they follow its outline; the
/// other three cross the gap beside it, where a petal of the wreath behind shows.
inline Throne::PetalPoint Throne::petal(int column, double along) {
    constexpr int half = columnsPerPetal / 2, edge = 3;
    const int place = column % columnsPerPetal - half; // -5 … 4, 0 in the petal's middle
    const int away = std::abs(place);
    const double closing = std::clamp((along - 0.25) / 0.75, 0.0, 1.0);
    const double halfWidth = 0.93 * std::max(0.14, std::sqrt(1.0 - std::pow(closing, 1.7)));
    double u, relief; // u: 0 in the petal's middle, 1 where two meet
    if (away <= edge) {
        const double v = double(away) / edge;
        u = halfWidth * v;
        const double rim = 1.0 - 0.55 * std::pow(v, 6);
        relief =
            1.8 + rim * (3.0 - 1.6 * v * v * (1.0 - 0.6 * along) + 0.5 * bump(v, 0.3) * smoothstep(0.3, 0.9, along));
    } else {
        u = away == half ? 1.0 : mix(halfWidth, 1.0, 0.12);
        relief = 1.8 * (1.0 - (1.0 - u) * 0.6) * smoothstep(0.0, 0.5, along);
    }
    const double turn =
        (std::floor(double(column) / columnsPerPetal) + 0.5 + (place < 0 ? -0.5 : 0.5) * u) / petalCount;
    return {turn, relief};
}

inline V3d Throne::at(int column, int row) const {
    const Level& level = profile_[static_cast<std::size_t>(row)];
    double out = level.out, z = level.z;
    double turn = double(column) / (columnsPerPetal * petalCount);
    const PetalPoint point = petal(column, level.along);
    if (level.wreath == Wreath::none) {
        turn = mix(turn, point.turn, level.gather);
    } else {
        const double root = smoothstep(0.0, 0.12, level.along); // the columns come together at the root
        turn = mix(turn, point.turn, root);
        const double curl =
            2.2 * smoothstep(0.5, 1.0, level.along) * smoothstep(1.5, 3.0, point.relief); // tips bend away
        out += root * point.relief + curl;
        z += (level.wreath == Wreath::upper ? -0.2 : 0.2) * root * point.relief;
    }
    const double a = angle(turn);
    return V3d((width_ + out) * std::cos(a), (depth_ + out) * std::sin(a) - 10.0, z);
}

inline V3d Throne::inside(double turn, double share, int row) const {
    const Level& level = profile_[static_cast<std::size_t>(row)];
    const double a = angle(turn);
    return V3d((width_ + level.out) * std::cos(a) * share, (depth_ + level.out) * std::sin(a) * share - 10.0, level.z);
}

} // namespace patina::statuette
