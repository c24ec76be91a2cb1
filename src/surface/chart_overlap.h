#pragma once
// Whether triangles of a chart lie on each other.

#include <Imath/ImathVec.h>

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace patina {

using FlatTriangle = std::array<Imath::V2d, 3>;

/// Whether the insides of two triangles meet by more than rounding; never where one has no area.
bool overlap(const FlatTriangle& a, const FlatTriangle& b);

/// Triangles in a plane that do not overlap, found by place.
class FlatTriangles {
  public:
    /// \param cell  side of the squares that triangles are sorted into: about an edge's length, above 0
    explicit FlatTriangles(double cell) : cell_(cell) {}

    /// Adds the triangle unless it overlaps one that is there. \return whether it was added
    bool add(const FlatTriangle& triangle);

  private:
    double cell_;
    std::vector<FlatTriangle> triangles_;
    std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

} // namespace patina
