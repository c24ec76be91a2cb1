#include "render/path_kernels.h"

#include "base/lane_kernel.h"
#include "base/turns.h"
#include "render/scrambled_sobol.h"

#include <cmath>

namespace patina {

namespace {

constexpr float pi = float(M_PI);

PATINA_LANE_BODY float greater(float a, float b) {
    return a < b ? b : a;
}
PATINA_LANE_BODY float smaller(float a, float b) {
    return b < a ? b : a;
}

PATINA_LANE_BODY void drawLanesBody(const DrawLanes& lanes) {
    const int* path = lanes.path;
    float *u = lanes.u, *v = lanes.v;
    PATINA_LANES
    for (std::size_t i = 0; i < lanes.count; ++i) {
        const int pixel = lanes.pixelOf[path[i]];
        scrambledSobol(lanes.sampleOf[path[i]], lanes.seed0[pixel], lanes.seed1[pixel], lanes.seed2[pixel], u[i], v[i]);
    }
}

PATINA_LANE_BODY void shadeLanesBody(const ShadeLanes& lanes) {
    const int* from = lanes.from;
    const int* triangles = lanes.triangles;
    const float *positions = lanes.positions, *normals = lanes.normals;
    const ConstVectors ng = lanes.geometricNormal, rays = lanes.direction;
    const Vectors position = lanes.position, origin = lanes.origin, wo = lanes.wo;
    const Vectors tangent = lanes.shading.tangent, bitangent = lanes.shading.bitangent, shading = lanes.shading.normal;
    PATINA_LANES
    for (std::size_t i = 0; i < lanes.count; ++i) {
        const int ray = from[i], t = 3 * lanes.triangle[ray];
        const int a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
        const float wb = lanes.u[ray], wc = lanes.v[ray], wa = 1.f - wb - wc;
        const float dx = rays.x[ray], dy = rays.y[ray], dz = rays.z[ray];
        float gx = ng.x[ray], gy = ng.y[ray], gz = ng.z[ray];
        const float side = gx * dx + gy * dy + gz * dz > 0.f ? -1.f : 1.f;
        const float ax = positions[a], ay = positions[a + 1], az = positions[a + 2];
        const float bx = positions[b], by = positions[b + 1], bz = positions[b + 2];
        const float cx = positions[c], cy = positions[c + 1], cz = positions[c + 2];
        const float px = ax * wa + bx * wb + cx * wc;
        const float py = ay * wa + by * wb + cy * wc;
        const float pz = az * wa + bz * wb + cz * wc;
        const float nax = normals[a] * side, nay = normals[a + 1] * side, naz = normals[a + 2] * side;
        const float nbx = normals[b] * side, nby = normals[b + 1] * side, nbz = normals[b + 2] * side;
        const float ncx = normals[c] * side, ncy = normals[c + 1] * side, ncz = normals[c + 2] * side;
        float nx = nax * wa + nbx * wb + ncx * wc;
        float ny = nay * wa + nby * wb + ncy * wc;
        float nz = naz * wa + nbz * wb + ncz * wc;
        // Squares of the smallest triangles' normals would vanish.
        const float largest = greater(greater(std::abs(gx), std::abs(gy)), std::abs(gz));
        const float magnified = largest < 1e-12f ? 1e18f : 1.f;
        gx *= magnified, gy *= magnified, gz *= magnified;
        const float gLength = std::sqrt(gx * gx + gy * gy + gz * gz), perLength = gLength > 0.f ? gLength : 1.f;
        gx = gx / perLength * side, gy = gy / perLength * side, gz = gz / perLength * side;
        const float n2 = nx * nx + ny * ny + nz * nz, perN = 1.f / std::sqrt(n2);
        nx *= perN, ny *= perN, nz *= perN;
        const bool usable = n2 > 1e-12f && nx * gx + ny * gy + nz * gz > 0.f;
        nx = usable ? nx : gx, ny = usable ? ny : gy, nz = usable ? nz : gz;

        // The triangle stands for a curved surface that bulges out over it. Starting shadow rays from the planes
        // through the corners, weighted, instead of from the flat triangle takes the black facets off the terminator
        // (Hanika 2021, "Hacking the Shadow Terminator", Ray Tracing Gems II, chapter 4).
        const float belowA = smaller(0.f, (px - ax) * nax + (py - ay) * nay + (pz - az) * naz) * wa;
        const float belowB = smaller(0.f, (px - bx) * nbx + (py - by) * nby + (pz - bz) * nbz) * wb;
        const float belowC = smaller(0.f, (px - cx) * ncx + (py - cy) * ncy + (pz - cz) * ncz) * wc;
        const float lx = -(nax * belowA) - nbx * belowB - ncx * belowC;
        const float ly = -(nay * belowA) - nby * belowB - ncy * belowC;
        const float lz = -(naz * belowA) - nbz * belowB - ncz * belowC;
        position.x[i] = px, position.y[i] = py, position.z[i] = pz;
        origin.x[i] = px + lx + gx * lanes.clearance;
        origin.y[i] = py + ly + gy * lanes.clearance;
        origin.z[i] = pz + lz + gz * lanes.clearance;

        // A shading normal is turned just so far that a mirror ray along it does not go into the triangle (Keller et
        // al. 2017, "The Iray Light Transport Simulation and Rendering System", bends it likewise). Without it,
        // silhouettes of coarse meshes go black where the smooth normal looks away from the viewer.
        const float outN = -dx * nx - dy * ny - dz * nz, outG = -dx * gx - dy * gy - dz * gz;
        const float mx = 2.f * outN * nx + dx, my = 2.f * outN * ny + dy, mz = 2.f * outN * nz + dz;
        const float below = smaller(0.9f * outG, 0.02f) - (mx * gx + my * gy + mz * gz);
        const bool fits = below <= 0.f && outN > 0.f;
        const float lack = greater(below, 0.f);
        const float upX = mx + lack * gx, upY = my + lack * gy, upZ = mz + lack * gz;
        const float perUp = 1.f / std::sqrt(upX * upX + upY * upY + upZ * upZ);
        const float hx = upX * perUp - dx, hy = upY * perUp - dy, hz = upZ * perUp - dz;
        const float h2 = hx * hx + hy * hy + hz * hz, perH = 1.f / std::sqrt(h2);
        const bool bends = h2 > 1e-8f;
        nx = fits ? nx : bends ? hx * perH : gx;
        ny = fits ? ny : bends ? hy * perH : gy;
        nz = fits ? nz : bends ? hz * perH : gz;

        // frameAround()
        const float sign = std::copysign(1.f, nz), q = -1.f / (sign + nz), xy = nx * ny * q;
        const float tx = 1.f + sign * nx * nx * q, ty = sign * xy, tz = -sign * nx;
        const float sx = xy, sy = sign + ny * ny * q, sz = -ny;
        tangent.x[i] = tx, tangent.y[i] = ty, tangent.z[i] = tz;
        bitangent.x[i] = sx, bitangent.y[i] = sy, bitangent.z[i] = sz;
        shading.x[i] = nx, shading.y[i] = ny, shading.z[i] = nz;
        wo.x[i] = -dx * tx - dy * ty - dz * tz;
        wo.y[i] = -dx * sx - dy * sy - dz * sz;
        wo.z[i] = -dx * nx - dy * ny - dz * nz;
    }
}

PATINA_LANE_BODY void skyLanesBody(const SkyLanes& lanes) {
    const ConstVectors normal = lanes.normal;
    const Vectors direction = lanes.direction;
    PATINA_LANES
    for (std::size_t i = 0; i < lanes.count; ++i) {
        // A point of the sphere that touches the surface from above, seen from where it touches, is as likely as the
        // cosine of its direction.
        const float z = 1.f - 2.f * lanes.u[i], r = std::sqrt(greater(0.f, 1.f - z * z));
        const CirclePoint around = circlePoint(lanes.v[i]);
        const float nx = normal.x[i], ny = normal.y[i], nz = normal.z[i];
        const float x = nx + r * around.cosine, y = ny + r * around.sine, up = nz + z;
        const float length = std::sqrt(x * x + y * y + up * up);
        const float dx = x / length, dy = y / length, dz = up / length;
        direction.x[i] = dx, direction.y[i] = dy, direction.z[i] = dz;
        const float density = greater(nx * dx + ny * dy + nz * dz, 0.f) / pi;
        lanes.density[i] = length > 1e-4f ? density : 0.f;
    }
}

PATINA_LANE_BODY void localLanesBody(const LocalLanes& lanes) {
    const Vectors tangent = lanes.frame.tangent, bitangent = lanes.frame.bitangent, normal = lanes.frame.normal;
    const ConstVectors world = lanes.world;
    const Vectors local = lanes.local;
    PATINA_LANES
    for (std::size_t i = 0; i < lanes.count; ++i) {
        const float x = world.x[i], y = world.y[i], z = world.z[i];
        local.x[i] = x * tangent.x[i] + y * tangent.y[i] + z * tangent.z[i];
        local.y[i] = x * bitangent.x[i] + y * bitangent.y[i] + z * bitangent.z[i];
        local.z[i] = x * normal.x[i] + y * normal.y[i] + z * normal.z[i];
    }
}

PATINA_LANE_BODY void arriveLanesBody(const ArriveLanes& lanes) {
    const ConstVectors wi = lanes.wi, value = lanes.value, radiance = lanes.radiance, throughput = lanes.throughput;
    const Vectors light = lanes.light;
    const float bound = lanes.bound > 0.f ? lanes.bound : 3.4e38f;
    PATINA_LANES
    for (std::size_t i = 0; i < lanes.count; ++i) {
        const float density = lanes.density[i], up = wi.z[i];
        // Power heuristic by the ratio, so that squares of large densities do not overflow.
        const float ratio = lanes.pdf[i] / density, share = 1.f / (1.f + ratio * ratio);
        const float weight = lanes.lightsDone[i] != 0 ? 1.f : share;
        const float cosine = up / density;
        float x = throughput.x[i] * (value.x[i] * cosine * radiance.x[i] * weight);
        float y = throughput.y[i] * (value.y[i] * cosine * radiance.y[i] * weight);
        float z = throughput.z[i] * (value.z[i] * cosine * radiance.z[i] * weight);
        const float most = greater(greater(x, y), z), scale = most > bound ? bound / most : 1.f;
        light.x[i] = x * scale, light.y[i] = y * scale, light.z[i] = z * scale;
        lanes.most[i] = density > 0.f && up > 0.f && most > 0.f ? most : 0.f;
    }
}

PATINA_LANE_BODY void goOnLanesBody(const GoOnLanes& lanes) {
    const Vectors tangent = lanes.frame.tangent, bitangent = lanes.frame.bitangent, normal = lanes.frame.normal;
    const ConstVectors wi = lanes.wi, value = lanes.value;
    const Vectors throughput = lanes.throughput, direction = lanes.direction;
    PATINA_LANES
    for (std::size_t i = 0; i < lanes.count; ++i) {
        const float lx = wi.x[i], ly = wi.y[i], lz = wi.z[i], pdf = lanes.pdf[i];
        const float cosine = lz / pdf;
        const float wx = value.x[i] * cosine, wy = value.y[i] * cosine, wz = value.z[i] * cosine;
        const float x = throughput.x[i] * wx, y = throughput.y[i] * wy, z = throughput.z[i] * wz;
        throughput.x[i] = x, throughput.y[i] = y, throughput.z[i] = z;
        lanes.most[i] = greater(greater(x, y), z);
        const float weight = greater(greater(wx, wy), wz);
        lanes.weight[i] = pdf > 0.f && lz > 0.f ? weight : 0.f;
        const float dx = tangent.x[i] * lx + bitangent.x[i] * ly + normal.x[i] * lz;
        const float dy = tangent.y[i] * lx + bitangent.y[i] * ly + normal.y[i] * lz;
        const float dz = tangent.z[i] * lx + bitangent.z[i] * ly + normal.z[i] * lz;
        const float scale = 1.f / std::sqrt(dx * dx + dy * dy + dz * dz);
        direction.x[i] = dx * scale, direction.y[i] = dy * scale, direction.z[i] = dz * scale;
    }
}

} // namespace

PATINA_LANE_KERNEL(drawLanes, DrawLanes)
PATINA_LANE_KERNEL(shadeLanes, ShadeLanes)
PATINA_LANE_KERNEL(skyLanes, SkyLanes)
PATINA_LANE_KERNEL(localLanes, LocalLanes)
PATINA_LANE_KERNEL(arriveLanes, ArriveLanes)
PATINA_LANE_KERNEL(goOnLanes, GoOnLanes)

} // namespace patina
