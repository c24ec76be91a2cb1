#pragma once
// The fields of a volume, each computed once for each state of its surface.

#include "base/progress.h"
#include "operators/fields/exposure.h"
#include "operators/fields/sun_and_sky.h"
#include "operators/maps/thickness_map.h"
#include "volume/surface_binding.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace patina {

/// `accessibility(3mm)`, `accessibility(3mm, global=yes)`, `accessibility(6mm, soft=2mm)`.
struct AccessibilityRequest {
    double radius = 0.0;   ///< scene units of the volume, > 0
    double radiusUm = 0.0; ///< the same in real µm, for the name
    bool global = false;
    double soft = 0.0;   ///< scene units; twice the standard deviation of the mean along the surface, 0: none
    double softUm = 0.0; ///< the same in real µm

    std::string fieldName() const; ///< "accessibility_3mm", "accessibility_6mm_soft2mm_global"
    std::string text() const;      ///< all of it, exactly
};

/// `exposure`, `exposure(sky=overcast, latitude=45, months=(4, 9), rays=256, ground=yes)`.
struct ExposureRequest {
    SunAndSky light;
    std::optional<Imath::V3d> north; ///< of the model; not set: Compass::usualNorth()
    int rays = 256;
    bool ground = false;

    /// "exposure", "exposure_overcast_latitude52"
    std::string fieldName(const std::string& word = "exposure") const;
    std::string text() const; ///< all of it, exactly
};

/// Where the fields are computed and kept.
///
/// A field is a function of the volume's present state and of nothing else, so that a run that is interrupted and
/// resumed, or continued by `open`, has the same bits: where the whole stack is thinner than a quarter of a voxel, it
/// is computed on the metal (and then stays true while films come and go); where it is thicker, on the present surface.
/// It is computed again only where that surface's values have changed, and not where the volume came with the field:
/// with its grid stands a hash of all that it was made from.
class FieldStore {
  public:
    struct Scene {
        LayerVolume* volume = nullptr;
        const SurfaceBinding* binding = nullptr;
        Imath::V3d up{0.0, 1.0, 0.0};
        /// Rays of the whole model in the volume's coordinates, where the volume is a cut of it; else null.
        const RayScene* whole = nullptr;
        /// Lowest and highest point of the whole model along up, in the volume's coordinates, scene units.
        double lowest = 0.0, highest = 1.0;
    };

    explicit FieldStore(const Scene& scene) : scene_(scene) {}

    /// Maps to be asked in the volume's coordinates. The field is in NestGrids::fields afterwards.
    /// \throws RunError, Interrupted
    ThicknessMapPtr accessibility(const AccessibilityRequest& request, Progress& progress);
    ThicknessMapPtr exposure(const ExposureRequest& request, Progress& progress);
    /// `wetness`, dried by this exposure; named like it ("wetness", "wetness_latitude52").
    ThicknessMapPtr wetness(const ExposureRequest& request, Progress& progress);

  private:
    struct Kept {
        std::uint64_t surface = 0; ///< hash of the interface that it was computed on
        std::string request;       ///< names round their numbers
        ThicknessMapPtr map;
    };
    struct Surface {
        int layer = 0;
        std::uint64_t hash = 0;
        SurfaceVoxels voxels;
    };

    const Surface& presentSurface();
    enum class Reading { lattice, bySides }; ///< trilinear; or that and readBySides()
    const ThicknessMapPtr* find(const std::string& name, const std::string& request,
                                Reading reading = Reading::lattice);
    ThicknessMapPtr keep(const std::string& name, const std::string& request, const std::vector<float>& values,
                         Reading reading = Reading::lattice);
    ThicknessMapPtr mapOf(const std::string& name, Reading reading) const;
    std::optional<Obstacles> modelObstacles() const; ///< not where a layered surface must be made a mesh
    std::string originOf(const std::string& name, const std::string& request) const;
    std::vector<float> accessibilityValues(const AccessibilityRequest& request, Progress& progress);
    std::vector<float> exposureValues(const ExposureRequest& request, Progress& progress);
    std::vector<float> gather(const LightDome& dome, const Compass& compass, const DomeGathering& options,
                              Progress& progress);

    Scene scene_;
    Surface surface_;
    bool surfaceKnown_ = false;
    /// The last exposure, by voxels: wetness and exposure of one sky are asked for together.
    struct {
        std::uint64_t surface = 0;
        std::string request; ///< empty: none yet
        std::vector<float> values;
    } lastExposure_;
    std::map<std::string, Kept> kept_;
};

} // namespace patina
