#pragma once
// The tables that an environment's light is sampled by: directions for surfaces with some normal.

#include "base/vector_lanes.h"
#include "render/frame.h"

#include <Imath/ImathVec.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace patina {

/// The sphere in cells of equal solid angle: `columns` around, `rows` along the height above the horizon. One table for
/// each of a few normals, 20 degrees apart. A cell's chance is what its entry differs by from the one before, so that
/// density and sampling agree to the bit.
/// Immutable after construction; safe from any thread.
class LightTables {
  public:
    static constexpr int columns = 192;
    static constexpr int rows = 96;

    LightTables() = default;
    /// \param luminances  of the cells, row by row from below, each above 0
    /// \param frame       normal: up; columns are counted from its tangent
    /// \param skyOnly     cells below the horizon are never drawn
    LightTables(const std::vector<float>& luminances, const Frame& frame, bool skyOnly);

    bool empty() const { return columnEnds_.empty(); }
    /// The table for surfaces with this normal.
    int tableFor(const Imath::V3f& normal) const;

    struct Sample {
        Imath::V3f direction; ///< unit
        float pdf;            ///< per solid angle
    };
    /// \param position  0…1 both ways
    Sample sample(int table, const Imath::V2f& position) const;
    /// Density with which sample() draws this direction.
    float density(int table, const Imath::V3f& direction) const;

    /// The same of many lanes, to the bit. Arrays have room up to the next multiple of 16 of `count`, and tables there
    /// are some of these.
    struct AimLanes {
        std::size_t count;
        ConstVectors normal;
        int* table;
    };
    void aim(const AimLanes& lanes) const;
    struct SampleLanes {
        std::size_t count;
        const int* table;
        const float *u, *v; ///< across and along the height
        Vectors direction;
        float* density;
    };
    void sample(const SampleLanes& lanes) const;
    struct DensityLanes {
        std::size_t count;
        const int* table;
        ConstVectors direction;
        float* density;
    };
    void density(const DensityLanes& lanes) const;

    /// A direction of the upright frame from its place in a cell, both places 0…1.
    static Imath::V3f cellDirection(int row, int column, float down, float across);

    /// Where the kernels find everything. Running sums end at 1; a search reads the last sums of groups of 16 first and
    /// then one such group, which is one cache line.
    struct View {
        const float *rowGroupEnds, *rowEnds;       ///< of each table
        const float *columnGroupEnds, *columnEnds; ///< of each table's rows
        Frame frame;
    };

  private:
    void append(const std::vector<float>& luminances, const Imath::V3f& normal, bool skyOnly);
    View view() const;

    Frame frame_;
    std::vector<float> rowGroupEnds_, rowEnds_, columnGroupEnds_, columnEnds_;
};

} // namespace patina
