#include "export/bake.h"

#include "export/outer_surface.h"
#include "export/texel_map.h"
#include "operators/fields/field_grid.h"
#include "optics/colour.h"
#include "volume/nest_grids.h"
#include "volume/stack_probe.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace patina {

namespace {

// The maps while they are being baked, in the order of the files.
struct Planes {
    MapImage displacement, diffuse, baseColour, metallic, roughness, normal, materialId, foldMask, vectors;
    std::vector<MapImage> lobes, thickness, coverage, fields;
};

MapImage plane(const std::string& name, int size, int channels, bool isColour, bool isFloat) {
    MapImage map;
    map.name = name;
    map.size = size;
    map.channels = channels;
    map.isColour = isColour;
    const std::size_t count = static_cast<std::size_t>(size) * size * channels;
    if (isFloat)
        map.floats.assign(count, 0.f);
    else
        map.halves.assign(count, Imath::half(0.f));
    return map;
}

void put(MapImage& map, std::size_t texel, float value) {
    if (map.halves.empty())
        map.floats[texel] = value;
    else
        map.halves[texel] = Imath::half(value);
}

void put(MapImage& map, std::size_t texel, const Imath::V3f& colour) {
    for (int c = 0; c < 3; ++c)
        put(map, texel * 3 + c, colour[c]);
}

Planes makePlanes(const LayerVolume& volume, const BakeOptions& options) {
    const int size = options.resolution;
    Planes planes;
    planes.displacement = plane("displacement", size, 1, false, true);
    planes.diffuse = plane("diffuse", size, 3, true, false);
    planes.baseColour = plane("base_color", size, 3, true, false);
    planes.metallic = plane("metallic", size, 1, false, false);
    planes.roughness = plane("roughness", size, 1, false, false);
    planes.normal = plane("normal", size, 3, false, false);
    planes.lobes.push_back(plane(fmt::format("lobe_00_{}", volume.metal()), size, 3, true, false));
    for (int k = 1; k <= volume.layerCount(); ++k) {
        const std::string layer = fmt::format("{:02d}_{}", k, volume.layers()[k - 1]);
        planes.lobes.push_back(plane("lobe_" + layer, size, 3, true, false));
        planes.thickness.push_back(plane("thickness_" + layer, size, 1, false, true));
        planes.coverage.push_back(plane("coverage_" + layer, size, 1, false, false));
    }
    if (options.materialId)
        planes.materialId = plane("material_id", size, 1, false, true);
    if (options.foldMask)
        planes.foldMask = plane("fold_mask", size, 1, false, false);
    if (options.vectorDisplacement)
        planes.vectors = plane("vector_displacement", size, 3, false, true);
    if (options.fields)
        for (const auto& field : volume.grids().fields)
            planes.fields.push_back(plane("field_" + field.first, size, 1, false, false));
    return planes;
}

// The tangent-space normal of the displaced surface, from the differences of the heights of neighbouring texels:
// along u the surface rises by dh/du over a length |dP/du|, and so for v.
void bakeNormals(const SurfaceMesh& surface, const TexelMap& texels, Planes& planes) {
    const int size = texels.size;
    const std::vector<float>& height = planes.displacement.floats;
    tbb::parallel_for(0, size, [&](int y) {
        for (int x = 0; x < size; ++x) {
            const std::size_t at = static_cast<std::size_t>(y) * size + x;
            const int triangle = texels.points[at].triangle;
            if (triangle < 0)
                continue;
            const Imath::V3i& uvCorner = surface.triangleUvs[triangle];
            const Imath::V3i& corner = surface.triangles[triangle];
            const Imath::V2d e1(surface.uvs[uvCorner[1]] - surface.uvs[uvCorner[0]]);
            const Imath::V2d e2(surface.uvs[uvCorner[2]] - surface.uvs[uvCorner[0]]);
            const Imath::V3d p1(surface.positions[corner[1]] - surface.positions[corner[0]]);
            const Imath::V3d p2(surface.positions[corner[2]] - surface.positions[corner[0]]);
            const double determinant = e1.x * e2.y - e1.y * e2.x;
            Imath::V3d normal(0.0, 0.0, 1.0);
            if (determinant != 0.0) {
                const Imath::V3d du = (p1 * e2.y - p2 * e1.y) / determinant;
                const Imath::V3d dv = (p2 * e1.x - p1 * e2.x) / determinant;
                const auto slope = [&](int dx, int dy, double length) {
                    const auto inChart = [&](int nx, int ny) {
                        return nx >= 0 && ny >= 0 && nx < size && ny < size &&
                               texels.points[static_cast<std::size_t>(ny) * size + nx].triangle >= 0;
                    };
                    const bool ahead = inChart(x + dx, y + dy), behind = inChart(x - dx, y - dy);
                    const double after = ahead ? height[at + dx + static_cast<std::ptrdiff_t>(dy) * size] : height[at];
                    const double before =
                        behind ? height[at - dx - static_cast<std::ptrdiff_t>(dy) * size] : height[at];
                    const double steps = (ahead ? 1.0 : 0.0) + (behind ? 1.0 : 0.0);
                    return steps > 0.0 && length > 0.0 ? (after - before) * size / (steps * length) : 0.0;
                };
                // Rows run against v.
                normal = Imath::V3d(-slope(1, 0, du.length()), slope(0, 1, dv.length()), 1.0).normalized();
            }
            put(planes.normal, at, Imath::V3f(normal * 0.5 + Imath::V3d(0.5)));
        }
    });
}

// From the base to the surface above. Layers thinner than half a voxel go straight up.
Imath::V3d vectorOf(const OuterSurface& outer, const StackProbe::Reading& reading, const Imath::V3d& position,
                    const Imath::V3d& normal, double voxelSize) {
    if (!reading.found || reading.projected || reading.height < 0.5 * voxelSize)
        return normal * reading.height;
    const Imath::V3d base = position + normal * reading.baseOffset;
    const auto end = outer.above(base);
    return end ? *end - base : normal * reading.height;
}

void fillGutter(const TexelMap& texels, MapImage& map) {
    for (const auto& [to, from] : texels.gutter)
        for (int c = 0; c < map.channels; ++c) {
            if (map.halves.empty())
                map.floats[std::size_t(to) * map.channels + c] = map.floats[std::size_t(from) * map.channels + c];
            else
                map.halves[std::size_t(to) * map.channels + c] = map.halves[std::size_t(from) * map.channels + c];
        }
}

// Per row, then over the rows in order: the sums do not depend on the threads.
struct RowSums {
    std::size_t covered = 0, unreadable = 0, green = 0, foldsAsked = 0, folds = 0;
    float maxDisplacement = 0.f;
    Imath::V3d colour{0.0};
};

} // namespace

const MapImage* MapSet::find(const std::string& name) const {
    for (const MapImage& map : maps)
        if (map.name == name)
            return &map;
    return nullptr;
}

MapSet bake(const LayerVolume& volume, const SurfaceMesh& surface, const StackOptics& optics,
            const BakeOptions& options, Progress& progress) {
    const TexelMap texels = makeTexelMap(surface, options.resolution, options.gutter);
    progress.checkpoint();
    const StackProbe probe(volume);
    const int size = options.resolution;
    const int layers = volume.layerCount();
    const ColourSpace space = optics.features().colourSpace;
    const double displacementScale = options.keepExaggeration ? 1.0 : 1.0 / volume.scale().exaggeration;
    std::vector<float> ids{1.f};
    for (const std::string& layer : volume.layers())
        ids.push_back(static_cast<float>(volume.findMaterialId(layer)));

    const OuterSurface outer(volume);
    std::vector<ThicknessMapPtr> fields;
    if (options.fields)
        for (const auto& field : volume.grids().fields)
            fields.push_back(makeFieldMap(volume, field.first));

    Planes planes = makePlanes(volume, options);
    std::vector<RowSums> rows(size);
    tbb::parallel_for(0, size, [&](int y) {
        if (progress.cancelled())
            return;
        std::vector<double> thickness(std::max(layers, 1));
        std::vector<float> thicknessUm(std::max(layers, 1));
        Appearance look;
        RowSums& row = rows[y];
        for (int x = 0; x < size; ++x) {
            const std::size_t at = static_cast<std::size_t>(y) * size + x;
            const SurfacePoint& point = texels.points[at];
            if (point.triangle < 0)
                continue;
            ++row.covered;
            const Imath::V3d position = positionAt(surface, point), normal = normalAt(surface, point);
            const auto reading = probe.read(position, normal, thickness.data());
            if (!reading.found)
                ++row.unreadable;
            int visible = 0;
            for (int k = 0; k < layers; ++k) {
                thicknessUm[k] = static_cast<float>(thickness[k]);
                if (thickness[k] > 1e-3)
                    visible = k + 1;
                put(planes.thickness[k], at, thicknessUm[k]);
            }
            if (visible > 0)
                put(planes.coverage[visible - 1], at, 1.f);
            if (options.materialId)
                put(planes.materialId, at, ids[visible]);
            const float height = static_cast<float>(reading.height * displacementScale);
            put(planes.displacement, at, height);
            row.maxDisplacement = std::max(row.maxDisplacement, std::abs(height));
            bool folds = false;
            // Without the mask one texel of sixteen tells the fraction.
            if (reading.found && !reading.projected && (options.foldMask || (x % 4 == 0 && y % 4 == 0))) {
                const Imath::V3d floor = position + normal * (reading.baseOffset + reading.metalHeight);
                folds = outer.foldsOver(floor, normal);
                ++row.foldsAsked;
                row.folds += folds;
            }
            if (options.foldMask)
                put(planes.foldMask, at, folds ? 1.f : 0.f);
            if (options.vectorDisplacement) {
                const Imath::V3d vector = vectorOf(outer, reading, position, normal, volume.scale().voxelSize);
                put(planes.vectors, at, Imath::V3f(vector * displacementScale));
            }
            for (std::size_t f = 0; f < fields.size(); ++f)
                put(planes.fields[f], at,
                    static_cast<float>(fields[f]->value({position, normal, point.triangle, point.u, point.v})));

            optics.evaluate(thicknessUm.data(), look);
            put(planes.diffuse, at, look.diffuse);
            for (int k = 0; k <= layers; ++k)
                put(planes.lobes[k], at, look.lobes[k].colour);
            put(planes.baseColour, at, look.baseColour);
            put(planes.metallic, at, look.metallic);
            put(planes.roughness, at, look.flattenedRoughness);
            const Imath::V3d xyz = xyzFromLinear(Imath::V3d(look.baseColour), space);
            row.colour += linearRec709FromXyz(xyz);
            if (labFromXyz(xyz).y < -4.0)
                ++row.green;
        }
    });
    progress.checkpoint();
    bakeNormals(surface, texels, planes);

    MapSet set;
    RowSums sums;
    for (const RowSums& row : rows) {
        sums.covered += row.covered;
        sums.unreadable += row.unreadable;
        sums.green += row.green;
        sums.foldsAsked += row.foldsAsked;
        sums.folds += row.folds;
        sums.colour += row.colour;
        sums.maxDisplacement = std::max(sums.maxDisplacement, row.maxDisplacement);
    }
    const double texelCount = static_cast<double>(std::max<std::size_t>(1, sums.covered));
    set.summary.coveredFraction = static_cast<double>(sums.covered) / (static_cast<double>(size) * size);
    set.summary.unreadableFraction = static_cast<double>(sums.unreadable) / texelCount;
    set.summary.greenFraction = static_cast<double>(sums.green) / texelCount;
    set.summary.foldFraction =
        static_cast<double>(sums.folds) / static_cast<double>(std::max<std::size_t>(1, sums.foldsAsked));
    set.summary.meanColour = sums.colour / texelCount;
    set.summary.maxDisplacement = sums.maxDisplacement;

    planes.displacement.numbers.emplace_back("patina_max_displacement", sums.maxDisplacement);
    planes.displacement.texts.emplace_back("patina_units", "scene units along the normal, zero at the bare metal");
    if (options.foldMask)
        planes.foldMask.numbers.emplace_back("patina_fold_fraction", static_cast<float>(set.summary.foldFraction));
    if (options.vectorDisplacement)
        planes.vectors.texts.emplace_back("patina_units", "scene units, object space, from the bare metal");
    for (auto& thickness : planes.thickness)
        thickness.texts.emplace_back("patina_units", "real micrometres of solid");
    Appearance bare;
    optics.evaluate(std::vector<float>(std::max(layers, 1), 0.f).data(), bare);
    for (int k = 0; k <= layers; ++k) {
        planes.lobes[k].numbers.emplace_back("patina_ggx_alpha", bare.lobes[k].alpha);
        planes.lobes[k].numbers.emplace_back("patina_roughness", bare.lobes[k].roughness);
    }

    const auto take = [&](MapImage& map) {
        map.colourSpace = space;
        fillGutter(texels, map);
        set.maps.push_back(std::move(map));
    };
    take(planes.displacement);
    take(planes.diffuse);
    for (MapImage& lobe : planes.lobes)
        take(lobe);
    take(planes.baseColour);
    take(planes.metallic);
    take(planes.roughness);
    take(planes.normal);
    for (int k = 0; k < layers; ++k) {
        take(planes.thickness[k]);
        take(planes.coverage[k]);
    }
    if (options.materialId)
        take(planes.materialId);
    if (options.foldMask)
        take(planes.foldMask);
    if (options.vectorDisplacement)
        take(planes.vectors);
    for (MapImage& field : planes.fields)
        take(field);
    return set;
}

} // namespace patina
