#pragma once
// All the light of a picture: an environment, a key light and lights in the scene, sampled by importance.

#include "render/area_light.h"
#include "render/environment.h"
#include "render/light_tables.h"

#include <Imath/ImathBox.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace patina {

/// A sun-like disc infinitely far away. Its angular radius sets how soft the shadows are (the sun's is 0.27 degrees, a
/// one-metre umbrella two metres away about 14).
struct KeyLight {
    Imath::V3f direction{0, 0, 1};    ///< unit, towards the light
    float angularRadiusDegrees = 4.f; ///< 0.05…60
    Imath::V3f irradiance{1, 1, 1};   ///< on a surface that faces it, linear Rec.709

    /// The radiance of the disc: a disc of half-angle a irradiates a facing surface by pi sin² a times its radiance.
    Imath::V3f radiance() const;
};

/// Environment and key light are infinitely far away: radiances over directions with a density to sample them by. Area
/// lights stand in the scene and are asked for at a place.
/// Immutable after construction; safe from any thread.
class Lights {
  public:
    enum Source { environment, keyLight, areaLights };

    /// Environment and, optionally, a key light. `up` is the axis along which the tables of the environment stand.
    /// With `skyOnly` no shadow rays are sent below the horizon: right for a set with a floor, and for one without it
    /// the light from below is still found by paths that go there.
    /// \throws RunError for a key light out of range or a radiance that is negative or not finite.
    explicit Lights(std::shared_ptr<const Environment> environment, std::optional<KeyLight> key = {},
                    UpAxis up = UpAxis::z, bool skyOnly = false);

    /// Lights in the scene, besides the others. \param distance  from which they light the object, about: by it
    /// their part of all light is judged
    void setAreaLights(AreaLightSet lights, float distance);
    const AreaLightSet& area() const { return area_; }
    /// Whether the environment is the same from everywhere and sampled by the cosine alone.
    bool isEven() const { return tables_.empty(); }
    bool hasKey() const { return key_.has_value(); }

    /// Of one source, or of both that are far away together, from a unit direction.
    Imath::V3f radiance(Source source, const Imath::V3f& direction) const;
    Imath::V3f radiance(const Imath::V3f& direction) const;

    struct Sample {
        Imath::V3f direction; ///< unit
        Imath::V3f radiance;  ///< of this source alone
        float pdf;            ///< per solid angle; 0: nothing to see
    };
    /// What sampling for a surface with some normal needs to know, found once for all that is asked about it.
    struct Aim {
        int table = -1; ///< -1: light that is the same from everywhere is sampled by the cosine alone
        Imath::V3f normal{0, 0, 1};
    };
    Aim aim(const Imath::V3f& normal) const;
    /// For a surface with this normal: the environment is sampled in proportion to its radiance times, roughly, the
    /// cosine.
    Sample sample(Source source, Aim aim, const Imath::V2f& position) const;
    Sample sample(Source source, const Imath::V3f& normal, const Imath::V2f& position) const {
        return sample(source, aim(normal), position);
    }
    /// Density with which sample() of this source draws a direction for this normal.
    float pdf(Source source, Aim aim, const Imath::V3f& direction) const;
    float pdf(Source source, const Imath::V3f& normal, const Imath::V3f& direction) const {
        return pdf(source, aim(normal), direction);
    }

    /// Tables for the normals of many lanes. Arrays as RadianceLanes'.
    void aim(std::size_t count, const ConstVectors& normal, int* table) const;
    /// What sample() of the environment draws, to the bit; not where it is even.
    void sampleEnvironment(const LightTables::SampleLanes& lanes, const Vectors& radiance) const;
    /// Radiance of the environment.
    void environmentRadiance(const RadianceLanes& lanes) const { environment_->radiance(lanes); }
    /// Density with which sample() of the environment draws each direction; not where it is even.
    void environmentDensity(const LightTables::DensityLanes& lanes) const { tables_.density(lanes); }

    /// The part of the light that comes from this source, roughly: how often to choose it where only one is sampled.
    float chance(Source source) const {
        return source == areaLights ? areaChance_
                                    : (1.f - areaChance_) * (source == keyLight ? keyChance_ : 1.f - keyChance_);
    }

    /// Irradiance on an unoccluded surface with this unit normal, by quadrature over the table (about 1 % for soft
    /// environments), the key light in closed form where its whole disc is above the surface.
    Imath::V3f irradiance(const Imath::V3f& normal) const;
    /// The same at a place, with the lights in the scene.
    Imath::V3f irradiance(const Imath::V3f& normal, const Imath::V3f& position) const {
        return irradiance(normal) + area_.irradiance(position, normal);
    }

  private:
    std::shared_ptr<const Environment> environment_;
    std::optional<KeyLight> key_;
    Frame frame_;    ///< of the tables: normal is up
    Frame keyFrame_; ///< around the key light's direction
    Imath::V3f keyRadiance_{0.f};
    float keyVersine_ = 0.f; ///< 1 - cos of the key light's angular radius
    float keyChance_ = 0.f;
    AreaLightSet area_;
    float areaChance_ = 0.f;
    double environmentPower_ = 0.0; ///< roughly what a facing surface gets

    LightTables tables_; ///< none where the environment is uniform and all of it is sampled
};

/// Key light and set of the program's own pictures, as seen by a viewer at this azimuth: all of it infinitely far away.
Lights studioLights(UpAxis up, float azimuthDegrees = 0.f);

/// The same set as lights that stand around the object, four of its radii away: a lamp and a broad soft box (key), one
/// that fills from the right, a strip behind on each side (rim) and a lid, under a dim dome.
/// \param object  what they are pointed at, scene units \throws RunError where it has no size
Lights studioSet(UpAxis up, const Imath::Box3f& object, float azimuthDegrees = 0.f);

} // namespace patina
