#pragma once
// How often triangles wind round a point: the inside test that holes, cracks and overlaps do not lead astray.

#include <Imath/ImathVec.h>

#include <vector>

namespace patina {

/// The generalised winding number (Jacobson, Kavan, Sorkine-Hornung 2013),
///
///     w(q) = 1/(4 pi) · sum of the solid angles that the triangles, by their winding, subtend at q:
///
/// 1 inside a closed surface, 0 outside, 2 in the overlap of two, between where there are holes. Triangles far away are
/// taken together as one vector area (Barill et al. 2018, first order): the error is below 0.02. Immutable after
/// construction, the same on any number of threads; queries are safe from any thread.
class WindingNumber {
  public:
    WindingNumber(const std::vector<Imath::V3f>& positions, const std::vector<Imath::V3i>& triangles);

    double at(const Imath::V3d& point) const;

  private:
    struct Node {
        Imath::V3d centre;     ///< of area
        Imath::V3d vectorArea; ///< sum of areas times normals
        double area = 0.0;
        double radius = 0.0;   ///< of the ball round the centre that holds the triangles
        int first = 0, count = 0;
        int left = -1, right = -1; ///< -1: a leaf
    };
    void build(int node, const std::vector<Imath::V3d>& centroids);
    double sum(int node, const Imath::V3d& point) const;

    std::vector<Node> nodes_;
    std::vector<int> order_;
    std::vector<Imath::V3d> corners_; ///< three per triangle, in order_
};

} // namespace patina
