#include "render/look_kernels.h"

#include "base/lane_kernel.h"

namespace patina {

namespace {

PATINA_LANE_BODY void mixDiffuseLanesBody(const LookLanes& lanes) {
    const float* values = lanes.values;
    PATINA_LANES
    for (std::size_t i = 0; i < lanes.count; ++i) {
        const int hit = lanes.from[i], t = 3 * lanes.triangle[hit];
        const float u = lanes.u[hit], v = lanes.v[hit], w = 1.f - u - v;
        const int a = lanes.triangles[t] * lanes.stride, b = lanes.triangles[t + 1] * lanes.stride,
                  c = lanes.triangles[t + 2] * lanes.stride;
        lanes.diffuseX[i] = w * values[a] + u * values[b] + v * values[c];
        lanes.diffuseY[i] = w * values[a + 1] + u * values[b + 1] + v * values[c + 1];
        lanes.diffuseZ[i] = w * values[a + 2] + u * values[b + 2] + v * values[c + 2];
        lanes.meanAir[i] = 0.f;
        lanes.leastAir[i] = 0.f;
    }
}

PATINA_LANE_BODY void mixLobeLanesBody(const LobeLanes& lobe) {
    const LookLanes& lanes = lobe.lanes;
    const BsdfBatch::LobeRows to = lobe.to;
    const float alpha = lobe.shape.alpha, exponent = lobe.shape.exponent, rowWeight = lobe.shape.row.weight;
    const float flat = lobe.shape.mean.flat, rising = lobe.shape.mean.rising, leastAlbedo = lobe.shape.least;
    const int rowBelow = lobe.shape.row.below;
    const int *from = lanes.from, *triangle = lanes.triangle, *triangles = lanes.triangles;
    float *meanAir = lanes.meanAir, *leastAir = lanes.leastAir;
    const float* values = lanes.values + lobe.place;
    PATINA_LANES
    for (std::size_t i = 0; i < lanes.count; ++i) {
        const int hit = from[i], t = 3 * triangle[hit];
        const float u = lanes.u[hit], v = lanes.v[hit], w = 1.f - u - v;
        const int a = triangles[t] * lanes.stride, b = triangles[t + 1] * lanes.stride,
                  c = triangles[t + 2] * lanes.stride;
        const float x = w * values[a] + u * values[b] + v * values[c];
        const float y = w * values[a + 1] + u * values[b + 1] + v * values[c + 1];
        const float z = w * values[a + 2] + u * values[b + 2] + v * values[c + 2];
        const float edgeX = w * values[a + 3] + u * values[b + 3] + v * values[c + 3];
        const float edgeY = w * values[a + 4] + u * values[b + 4] + v * values[c + 4];
        const float edgeZ = w * values[a + 5] + u * values[b + 5] + v * values[c + 5];
        const float air = w * values[a + 6] + u * values[b + 6] + v * values[c + 6];
        const float airEdge = w * values[a + 7] + u * values[b + 7] + v * values[c + 7];
        // A lobe that is black is not there, as in PatinaBsdf::addLobe().
        const float xy = x > y ? x : y, most = z > xy ? z : xy;
        const float edgeXy = edgeX > edgeY ? edgeX : edgeY, mostEdge = edgeZ > edgeXy ? edgeZ : edgeXy;
        const bool there = (most > mostEdge ? most : mostEdge) > 0.f;
        to.bodyX[i] = there ? x - air : 0.f;
        to.bodyY[i] = there ? y - air : 0.f;
        to.bodyZ[i] = there ? z - air : 0.f;
        to.bodyEdgeX[i] = there ? edgeX - airEdge : 0.f;
        to.bodyEdgeY[i] = there ? edgeY - airEdge : 0.f;
        to.bodyEdgeZ[i] = there ? edgeZ - airEdge : 0.f;
        to.air[i] = there ? air : 0.f;
        to.airEdge[i] = there ? airEdge : 0.f;
        to.alpha[i] = alpha;
        to.exponent[i] = exponent;
        to.rowBelow[i] = rowBelow;
        to.rowWeight[i] = rowWeight;
        const float reflects = there ? airEdge : 0.f;
        const float mean = air * flat + airEdge * rising, least = air * leastAlbedo;
        meanAir[i] += reflects > 0.f ? mean : 0.f;
        leastAir[i] += reflects > 0.f ? least : 0.f;
    }
}

} // namespace

PATINA_LANE_KERNEL(mixDiffuseLanes, LookLanes)
PATINA_LANE_KERNEL(mixLobeLanes, LobeLanes)

} // namespace patina
