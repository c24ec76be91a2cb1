#pragma once
// A box cut out of a model: where it is, and the coordinates in which it is worked on.

#include <Imath/ImathBox.h>
#include <Imath/ImathVec.h>

#include <string>

namespace patina {

/// Close-ups are worked on relative to an origin near the box, a whole number of voxels away from the model's: single
/// precision would hold 7 nm at 10 cm. Voxel (i, j, k) of the volume is voxel (i, j, k) + originVoxels of the model's
/// lattice; the .vdb's transform says so too, so that other programs see the model's coordinates.
///
/// OpenVDB takes no voxels below 1e-5 units. Where they are smaller, the volume's units are the model's over
/// `magnification`, a power of two, so that nothing is rounded: "local" positions are (model - origin) * magnification,
/// and other programs see the model so many times larger.
struct Region {
    Imath::Box3d box;               ///< what was asked for, model coordinates, scene units
    Imath::V3i originVoxels{0};     ///< the origin, in voxels of the model's lattice
    double voxelSize = 0.0;         ///< scene units of the model
    double magnification = 1.0;     ///< volume's units per unit of the model: 1, 1024, 1024², …
    double reachVoxels = 4.0;       ///< how far from the metal the layers and operators may reach
    std::string pieceHash;          ///< of the piece's control mesh, as NAME.obj holds it

    Imath::V3d origin() const { return Imath::V3d(originVoxels) * voxelSize; }
    Imath::V3d toLocal(const Imath::V3d& inModel) const { return (inModel - origin()) * magnification; }
    Imath::V3d toModel(const Imath::V3d& local) const { return local / magnification + origin(); }
    Imath::Box3d local(const Imath::Box3d& inModel) const { return {toLocal(inModel.min), toLocal(inModel.max)}; }
    Imath::Box3d localBox() const { return local(box); }
    double localVoxelSize() const { return voxelSize * magnification; }

    /// Voxels around the box that are made besides it, so that what the box holds is what it would be in the whole
    /// model: band and operators see as far as reachVoxels.
    double marginVoxels() const;
    /// The box with its margin: where voxels are; model coordinates.
    Imath::Box3d voxelBox() const;
    /// The same in voxels of the volume: first and last index.
    Imath::Box3i voxelSides() const;
    /// Beyond that the surface that the outermost of these voxels measure their distance to; model coordinates.
    Imath::Box3d surfaceBox() const;

    /// One line of text, for the metadata `patina_region` of a volume.
    std::string text() const;
    /// \throws RunError naming `file` where the text is none of a region
    static Region fromText(const std::string& text, const std::string& file);

    /// The magnification that voxels of a size need.
    static double magnificationFor(double voxelSize);
};

/// A region around a box, its origin the voxel nearest to the box's middle.
/// \throws RunError where the voxels are too small to be counted at this distance from the model's origin
Region makeRegion(const Imath::Box3d& box, double voxelSize, double reachVoxels);

} // namespace patina
