#pragma once
// The stack of a surface between two moments of one history.

#include "surface/mesh.h"
#include "volume/layer_volume.h"
#include "volume/stack_probe.h"

#include <string>
#include <vector>

namespace patina {

/// One order of layers that holds both: those of `after`, and where they lay those that `before` alone has. A material
/// that lies in both in the same order is the same layer (the longest common subsequence).
std::vector<std::string> commonOrder(const std::vector<std::string>& before, const std::vector<std::string>& after);

/// Every layer's thickness and the height of the air go on a straight line from one moment to the other; a layer that
/// is missing in one of them has no thickness there. Colour does not: it follows from the stack, as it would for a
/// patina of that thickness. (A cross-dissolve mixes light: half of an opaque green over half of bare copper, and two
/// outlines where the surface moves.)
/// Safe from any thread; valid while volumes and surface are.
class StackBlend {
  public:
    /// \param before, after  two volumes of the same surface
    /// \throws RunError where they differ in metal or scale, or the layers of both are more than a stack may have
    StackBlend(const LayerVolume& before, const LayerVolume& after, const SurfaceMesh& surface);

    /// Materials, bottom to top.
    const std::vector<std::string>& layers() const { return layers_; }

    /// \param share  0: before, 1: after \param thicknessUm  receives one value for each of layers(), real µm
    void thickness(const SurfacePoint& point, float share, float* thicknessUm) const;
    /// Of the air above the base at every vertex, scene units as drawn in the volumes.
    std::vector<float> vertexHeights(float share) const;

  private:
    struct End {
        StackProbe probe;
        std::vector<std::size_t> places; ///< of its layers in layers_
        std::vector<float> heights;      ///< at the vertices
    };
    End endOf(const LayerVolume& volume) const;

    const SurfaceMesh& surface_;
    std::vector<std::string> layers_;
    End before_, after_;
};

} // namespace patina
