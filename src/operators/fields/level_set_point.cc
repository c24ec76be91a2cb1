#include "operators/fields/level_set_point.h"

#include <cmath>

namespace patina {

bool levelSetFoot(const NestSampler& sampler, int k, double voxelSize, const Imath::V3d& x, Imath::V3d& foot) {
    Imath::V3d p = foot;
    double residual = 1.0;
    for (int iteration = 0; iteration < 8; ++iteration) {
        Imath::V3d gradient;
        const double phi = sampler.valueAndGradient(k, sampler.locate(p), gradient) / voxelSize;
        gradient /= voxelSize;
        const double squared = gradient.length2();
        if (squared < 1e-4)
            return false;
        residual = std::abs(phi) / std::sqrt(squared);
        const Imath::V3d away = x - p;
        // Half the tangential step: a whole one overshoots where the surface is curved towards x.
        const Imath::V3d tangential = away - gradient * (away.dot(gradient) / squared);
        Imath::V3d step = gradient * (-phi / squared) + tangential * 0.5;
        const double length = step.length();
        if (length < 1e-3)
            break;
        if (length > 1.0)
            step /= length;
        p += step;
    }
    // The last tangential step may have left a curved surface again.
    for (int iteration = 0; iteration < 4; ++iteration) {
        Imath::V3d gradient;
        const double phi = sampler.valueAndGradient(k, sampler.locate(p), gradient) / voxelSize;
        gradient /= voxelSize;
        const double squared = gradient.length2();
        if (squared < 1e-4)
            return false;
        residual = std::abs(phi) / std::sqrt(squared);
        if (residual < 1e-4)
            break;
        p -= gradient * (phi / squared);
    }
    foot = p;
    return residual < 0.01;
}

Imath::V3d levelSetNormal(const NestSampler& sampler, int k, const Imath::V3d& point) {
    Imath::V3d gradient;
    for (int axis = 0; axis < 3; ++axis) {
        Imath::V3d step(0.0);
        step[axis] = 0.5;
        gradient[axis] =
            sampler.value(k, sampler.locate(point + step)) - sampler.value(k, sampler.locate(point - step));
    }
    const double length = gradient.length();
    return length > 0.0 ? gradient / length : Imath::V3d(0.0, 0.0, 1.0);
}

} // namespace patina
