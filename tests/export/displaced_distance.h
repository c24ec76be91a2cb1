#pragma once
// How far the limit mesh, displaced by a map as a renderer does it, lies from the outermost interface of a volume.

#include "export/bake.h"
#include "surface/ray_scene.h"
#include "surface/uv_frame.h"
#include "volume/nest_sampler.h"
#include "volume/stack_probe.h"

#include <openvdb/tools/VolumeToMesh.h>

#include <tbb/parallel_for.h>

#include <Imath/ImathBox.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace patina::test {

/// Of one direction, voxels.
struct DistanceFigures {
    std::size_t points = 0, masked = 0;
    double rms = 0.0, p999 = 0.0, max = 0.0;

    double maskedShare() const { return double(masked) / double(std::max<std::size_t>(1, masked + points)); }
};

/// Both directions: points of the displaced mesh to the interface, and of the interface to the displaced mesh. The voxels'
/// base lies beside the mesh where the lattice cuts an edge, and displacement, a difference from the base, does not hold
/// that: the mesh is first moved on to the base, along the normal. `meshAsItIs` is without. `fineTexels`: from the mesh, where
/// a texel is no wider than a voxel; stretched UVs make wider ones, which cannot hold what lies between their middles.
struct DisplacedDistance {
    DistanceFigures meshToVolume, volumeToMesh, meshAsItIs, fineTexels;
};

inline DistanceFigures figuresOf(std::vector<float>& distances, std::size_t masked) {
    DistanceFigures figures;
    figures.points = distances.size();
    figures.masked = masked;
    if (distances.empty())
        return figures;
    std::sort(distances.begin(), distances.end());
    double sum = 0.0;
    for (const float d : distances)
        sum += double(d) * d;
    figures.rms = std::sqrt(sum / static_cast<double>(distances.size()));
    figures.p999 = distances[static_cast<std::size_t>(0.999 * static_cast<double>(distances.size() - 1))];
    figures.max = distances.back();
    return figures;
}

/// A map read bilinearly between texel centres, as renderers do; row 0 is v = 1.
inline double readMap(const MapImage& map, const Imath::V2d& uv, int channel = 0) {
    const double x = uv.x * map.size - 0.5, y = (1.0 - uv.y) * map.size - 0.5;
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    double sum = 0.0;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const int cx = std::clamp(x0 + i, 0, map.size - 1), cy = std::clamp(y0 + j, 0, map.size - 1);
            const std::size_t at = (static_cast<std::size_t>(cy) * map.size + cx) * map.channels + channel;
            const double value = map.halves.empty() ? map.floats[at] : float(map.halves[at]);
            sum += value * (i ? x - x0 : 1.0 - (x - x0)) * (j ? y - y0 : 1.0 - (y - y0));
        }
    return sum;
}

/// \param dice    every triangle of the surface is cut into dice² of them
/// \param heights displacement (1 channel) or vector displacement (3) at the volume's scale
/// \param space   of vector displacement
/// \param folds   fold mask: what lies under it is left out on both sides, and so are triangles without an area in the UVs
/// \param inside  of the interface, only points in this box are asked; scene units
inline DisplacedDistance measureDisplaced(const LayerVolume& volume, const SurfaceMesh& surface,
                                          const MapImage& heights, const MapImage& folds, int dice,
                                          VectorSpace space = VectorSpace::object,
                                          const Imath::Box3d& inside = {Imath::V3d(-1e300), Imath::V3d(1e300)}) {
    const double voxel = volume.scale().voxelSize;
    // Corners of the dice, triangle by triangle.
    const int perTriangle = (dice + 1) * (dice + 2) / 2;
    const std::size_t triangles = surface.triangles.size();
    std::vector<Imath::V3f> positions(triangles * perTriangle), asItIs(positions.size());
    std::vector<char> folded(positions.size());
    std::vector<Imath::V3i> faces(triangles * dice * dice);
    const NestSampler sampler(volume.grids());
    const StackProbe probe(volume);
    const TangentFrames frames(surface);
    tbb::parallel_for(std::size_t(0), triangles, [&](std::size_t t) {
        std::size_t at = t * perTriangle;
        const bool shown = uvDerivativesOf(surface, static_cast<int>(t)).valid;
        std::vector<double> thickness(std::max(volume.layerCount(), 1));
        for (int j = 0; j <= dice; ++j)
            for (int i = 0; i + j <= dice; ++i, ++at) {
                const SurfacePoint point{static_cast<int>(t), float(i) / dice, float(j) / dice};
                const Imath::V2d uv = uvAt(surface, point);
                const Imath::V3d here = positionAt(surface, point), normal = normalAt(surface, point);
                Imath::V3d shift;
                if (heights.channels == 3)
                    shift = {readMap(heights, uv, 0), readMap(heights, uv, 1), readMap(heights, uv, 2)};
                else
                    shift = normal * readMap(heights, uv);
                if (heights.channels == 3)
                    shift = fromSpace(space, frames.interpolatedAt(point, normal), shift);
                const auto reading = probe.read(here, normal, thickness.data());
                const double offset = reading.found && !reading.projected ? reading.baseOffset : 0.0;
                asItIs[at] = Imath::V3f(here + shift);
                positions[at] = Imath::V3f(here + shift + normal * offset);
                folded[at] = !shown || readMap(folds, uv) > 0.0;
            }
        const auto corner = [&](int i, int j) {
            return static_cast<int>(t * perTriangle) + j * (dice + 1) - j * (j - 1) / 2 + i;
        };
        std::size_t face = t * dice * dice;
        for (int j = 0; j < dice; ++j)
            for (int i = 0; i + j < dice; ++i) {
                faces[face++] = {corner(i, j), corner(i + 1, j), corner(i, j + 1)};
                if (i + j + 1 < dice)
                    faces[face++] = {corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)};
            }
    });

    DisplacedDistance result;
    const int last = volume.layerCount();
    std::vector<float> distances;
    const auto unmasked = [](std::vector<float>& values) {
        const auto end = std::remove_if(values.begin(), values.end(), [](float d) { return d < 0.f; });
        const auto masked = static_cast<std::size_t>(values.end() - end);
        values.erase(end, values.end());
        return masked;
    };
    const auto isWide = [&](std::size_t triangle) {
        const UvDerivatives uv = uvDerivativesOf(surface, static_cast<int>(triangle));
        return std::max(uv.du.length(), uv.dv.length()) / heights.size > voxel;
    };
    const auto toVolume = [&](const std::vector<Imath::V3f>& from, bool onlyFine = false) {
        distances.resize(faces.size());
        tbb::parallel_for(std::size_t(0), faces.size(), [&](std::size_t f) {
            const Imath::V3i& face = faces[f];
            if (folded[face.x] || folded[face.y] || folded[face.z] ||
                (onlyFine && isWide(f / (std::size_t(dice) * dice)))) {
                distances[f] = -1.f;
                return;
            }
            const Imath::V3d middle =
                (Imath::V3d(from[face.x]) + Imath::V3d(from[face.y]) + Imath::V3d(from[face.z])) / (3.0 * voxel);
            Imath::V3d gradient;
            const double phi = sampler.valueAndGradient(last, sampler.locate(middle), gradient);
            // The interface's slope is not quite one: to first order its distance is phi over the slope.
            distances[f] = static_cast<float>(std::abs(phi) / std::max(gradient.length(), 0.5 * voxel));
        });
        const std::size_t masked = unmasked(distances);
        return figuresOf(distances, masked);
    };
    result.meshToVolume = toVolume(positions);
    result.meshAsItIs = toVolume(asItIs);
    result.fineTexels = toVolume(positions, true);

    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(volume.grids().surface(), points, quads, 0.0);
    const RayScene scene(positions, faces);
    distances.assign(points.size(), 0.f);
    tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t i) {
        // The mesher puts its points inside the cells; onto the crossing along the gradient.
        const openvdb::Vec3d at = volume.grids().surface().worldToIndex(points[i]);
        Imath::V3d point = (Imath::V3d(at.x(), at.y(), at.z()) + sampler.position(openvdb::Coord(0))) * voxel;
        for (int step = 0; step < 3; ++step) {
            Imath::V3d gradient;
            const double phi = sampler.valueAndGradient(last, sampler.locate(point / voxel), gradient);
            if (gradient.length2() > 0.0)
                point -= gradient * (phi / gradient.length2()) * voxel;
        }
        if (!inside.intersects(point)) {
            distances[i] = std::numeric_limits<float>::quiet_NaN();
            return;
        }
        const auto hit = scene.closest(Imath::V3f(point), static_cast<float>(40.0 * voxel));
        const Imath::V3i* face = hit ? &faces[hit->point.triangle] : nullptr;
        const bool left = !hit || folded[face->x] || folded[face->y] || folded[face->z];
        distances[i] = left ? -1.f : static_cast<float>(hit->distance / voxel);
    });
    distances.erase(std::remove_if(distances.begin(), distances.end(), [](float d) { return std::isnan(d); }),
                    distances.end());
    const std::size_t masked = unmasked(distances);
    result.volumeToMesh = figuresOf(distances, masked);
    return result;
}

} // namespace patina::test
