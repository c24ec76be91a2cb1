#pragma once
// Particles that come in at a slant: inside the room only.

#include "operators/growth/growth_lattice.h"
#include "operators/growth/level_occupancy.h"

#include <Imath/ImathVec.h>

#include <cstdint>
#include <vector>

namespace patina {

/// Steeper tracks than this (cells sideways per cell of height: 83 degrees off the normal) are taken as this.
constexpr double flattestTrack = 8.0;

/// Where particles of BD on straight oblique tracks first touch the layer (Meakin and Krug: columns lean towards the
/// source and stand apart). A particle is told by the cell its track would reach on the bare lattice, its foot; the
/// track is followed through the cells' columns, and the particle stays at the first place beside or on top of another.
/// What lies above a column's pores is passed below, where the track comes from the side.
class ObliqueTrack {
  public:
    /// \param towards      the source, unit
    /// \param levelHeight  of a level, cells
    /// \param relief       levels on which a cell's column begins
    ObliqueTrack(const GrowthLattice& lattice, const Imath::V3d& towards, double levelHeight,
                 const std::vector<std::int32_t>& relief);

    struct Place {
        int cell;
        std::int32_t level; ///< relief included
    };
    /// \param height     of every cell's envelope, levels, relief included
    /// \param highest    no cell is higher
    /// \param within     any number: where in the foot's cell the track ends
    Place firstContact(int foot, std::uint32_t within, const std::vector<std::int32_t>& height, std::int32_t highest,
                       const LevelOccupancy& occupancy);

  private:
    /// A piece of a track within one column, levels.
    struct Piece {
        int cell;
        float from, to;
    };
    /// Up the track from its foot, against the particle's way.
    void follow(int foot, std::uint32_t within, float top);
    bool isFilled(int cell, std::int32_t level, const LevelOccupancy& occupancy) const {
        return level <= relief_[std::size_t(cell)] ||
               occupancy.holds(std::size_t(cell), level - relief_[std::size_t(cell)]);
    }
    bool touches(int cell, std::int32_t level, const LevelOccupancy& occupancy) const;

    const GrowthLattice& lattice_;
    const std::vector<std::int32_t>& relief_;
    std::vector<Imath::V2f> drift_; ///< per cell: towards the source, along slots 1 and 3, cells per level
    std::vector<Piece> path_;       ///< of the particle under way
};

} // namespace patina
