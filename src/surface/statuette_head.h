#pragma once
// The statuette's head as distance functions. Head space: millimetres, x to the viewer's right, y towards the back of the head,
// z up, origin in the middle of the skull at the height of the eyes. Chin at z = -23, ushnisha up to z = 36.

#include "surface/sculpting.h"

namespace patina::statuette {

using sculpting::V3d;

/// Face, skull and hair with its curls, without the ears.
class Head {
  public:
    Head();
    double operator()(const V3d& p) const;

  private:
    /// Skull and topknot under the curls.
    double hairCap(const V3d& p) const;
    double face(const V3d& p) const;
    /// Positive where hair grows: millimetres above the hairline, roughly.
    static double hairline(const V3d& p);
    double curls(const V3d& p) const;

    struct CurlRow {
        double elevation; ///< radians above the horizon of the head's middle
        int count;
        double phase; ///< of the first curl, in curls
        std::vector<V3d> centres;
    };
    std::vector<CurlRow> curlRows_;
    sculpting::Strand brow_, upperLip_, lowerLip_, mouthLine_;
};

/// The right one of the ears (x > 0), standing in the head space; the other is its mirror image. `outward` is the distance from
/// the plane of the ear, `forward` and `up` lie in it, origin at the ear hole.
double earRelief(double forward, double up);  ///< millimetres above the ear's plane
double earOutline(double forward, double up); ///< distance to the outline, negative inside

} // namespace patina::statuette
