#pragma once
// Open sheets with a relief, and how their layers are measured: along z, so that the mean over an area is a volume.

#include "support/test_surfaces.h"
#include "volume/stack_probe.h"

namespace patina::test {

using Height = std::function<double(double x, double y)>;

/// A sheet of n × n quads over the square from the origin to (size, size) at z = height(x, y), facing up.
inline SurfaceMesh relief(float size, int n, const Height& height) {
    SurfaceMesh surface = sheet(size, n);
    const double step = 1e-3;
    for (std::size_t v = 0; v < surface.positions.size(); ++v) {
        Imath::V3f& p = surface.positions[v];
        p.z = static_cast<float>(height(p.x, p.y));
        const double dx = (height(p.x + step, p.y) - height(p.x - step, p.y)) / (2.0 * step);
        const double dy = (height(p.x, p.y + step) - height(p.x, p.y - step)) / (2.0 * step);
        surface.normals[v] = Imath::V3f(Imath::V3d(-dx, -dy, 1.0).normalized());
    }
    return surface;
}

/// Mean of a function of (x, y) over a square window, from `count`² evenly spread points.
inline double meanOver(double from, double to, int count, const Height& value) {
    double sum = 0.0;
    for (int j = 0; j < count; ++j)
        for (int i = 0; i < count; ++i)
            sum += value(from + (to - from) * (i + 0.5) / count, from + (to - from) * (j + 0.5) / count);
    return sum / (double(count) * count);
}

/// Thickness of layer k (from 1) above (x, y), in µm, and the height of the surface along z.
class Column {
  public:
    Column(const LayerVolume& volume, Height base)
        : probe_(volume), layers_(volume.layerCount()), base_(std::move(base)) {}

    double thickness(int k, double x, double y) const {
        std::vector<double> um(layers_ + 1);
        probe_.read({x, y, base_(x, y)}, {0.0, 0.0, 1.0}, um.data());
        return um[k - 1];
    }
    /// Surface minus base along z, scene units.
    double height(double x, double y) const {
        std::vector<double> um(layers_ + 1);
        return probe_.read({x, y, base_(x, y)}, {0.0, 0.0, 1.0}, um.data()).height;
    }

  private:
    StackProbe probe_;
    int layers_;
    Height base_;
};

/// A Gaussian random field of mean 0 and spread about 1: waves of random directions and phases, lengths 9 … 18.
class GaussianField {
  public:
    explicit GaussianField(int waves = 200) {
        // A golden-ratio sequence serves as random enough, and is the same everywhere.
        for (int i = 0; i < waves; ++i) {
            const auto part = [&](double step) { return std::fmod(0.5 + (i + 1) * step, 1.0); };
            const double angle = 2.0 * M_PI * part(0.7548776662466927), length = 9.0 + 9.0 * part(0.5698402909980532);
            waves_.push_back({2.0 * M_PI / length * std::cos(angle), 2.0 * M_PI / length * std::sin(angle),
                              2.0 * M_PI * part(0.6180339887498949)});
        }
    }
    double operator()(double x, double y) const {
        double sum = 0.0;
        for (const Imath::V3d& w : waves_)
            sum += std::cos(w.x * x + w.y * y + w.z);
        return sum * std::sqrt(2.0 / static_cast<double>(waves_.size()));
    }

  private:
    std::vector<Imath::V3d> waves_;
};

} // namespace patina::test
