#pragma once
// Daylight: a sky of the CIE's general types with its sun, as exposure knows them.

#include "render/lights.h"

namespace patina {

/// Where the sun stands and what the sky is like.
struct Daylight {
    int sky = 12;                    ///< type of CIE S 011 / ISO 15469, 1 … 15, or 16, the traditional overcast sky
    float sunAltitudeDegrees = 40.f; ///< -5 … 90
    float sunAzimuthDegrees = -50.f; ///< from the model's front, positive to its viewer's right
    bool sun = true;
    /// Share of the horizontal irradiance that is the sky's: about a tenth to a fifth under a clear one.
    float skyShare = 0.18f;
};

/// The sky's radiance distribution by the CIE's formula, the ground below it of albedo 0.2, and the sun as a disc of
/// 0.27 degrees. White: the CIE's skies have luminance but no colour. Scaled so that a white card on the ground is
/// about 1. \throws RunError where a value is out of range
Lights daylight(const Daylight& light, UpAxis up);

} // namespace patina
