#pragma once
// A grown pattern as a factor over the surface.

#include "operators/growth/growth_lattice.h"
#include "operators/maps/thickness_map.h"

#include <memory>
#include <vector>

namespace patina {

/// Half width of the tents by which a reader of a given pitch (its voxel size, the distance of its pixels) sees a pattern
/// of grains of size `grain`, so that what it makes of the values by interpolating between them is as wide whatever its
/// pitch: the grain where there are two values or more to it; less where there are fewer, for those are smoothed
/// again by their own interpolation; below one value to a grain, what makes block means of them. All in one unit.
double readingWidth(double grain, double pitch);

/// How far a pattern of cells is moved for such a reader, as GrowthMap takes it: a quarter of a cell where he has one
/// value to a grain, nothing where he has two or more.
double readingShift(double cell, double grain, double pitch);

/// Reads values of a lattice's cells at any point of the surface: each cell counts by its area times tents over the two
/// tangential directions of its column, times tents over the angle and the distance between the point and its plane.
/// Between columns of one direction that is bilinear interpolation. A point with no cell within reach takes the nearest
/// cell's value, or 0 where there is none within four cells.
class GrowthMap : public ThicknessMap {
  public:
    /// \param values one per cell, such as GrowthPattern::factor; copied, as is all that is needed of the lattice.
    /// \param filterWidth half width of the tents, scene units, at least 0.75 of a cell; 0: a cell. See readingWidth()
    /// \param shift      moves the pattern, scene units: a reader whose points lie on the borders of cells would see
    ///        means of two cells, one that is a little off sees cells.
    /// \throws RunError when the sizes differ.
    GrowthMap(const GrowthLattice& lattice, const std::vector<float>& values, double filterWidth = 0.0,
              double shift = 0.0);
    ~GrowthMap() override;

    /// Thread-safe; about 200 ns at a filter of one cell where points follow each other along the surface.
    double value(const MapPoint& point) const override;

  private:
    struct Index;
    std::unique_ptr<const Index> index_;
};

} // namespace patina
