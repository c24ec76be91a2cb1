#include "optics/microfacet.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace patina {

namespace {

using Imath::V3f;

constexpr float pi = 3.14159265358979f;
// Both axes are square roots: the albedo changes fastest towards grazing and for sharp lobes.
constexpr int cosineCount = 40;
constexpr int alphaCount = 32;
/// What the quadrature below may be off by (against 400 × 400 points: 0.0002), and the curve beside the middles.
constexpr float quadratureError = 5e-4f;

struct AlbedoTable {
    std::array<std::array<LobeAlbedo, cosineCount>, alphaCount> directional;
    std::array<LobeAlbedo, alphaCount> mean;
    std::array<float, alphaCount> least;
};

float lambda(const V3f& w, float alpha) {
    const float cosine2 = w.z * w.z;
    const float tangent2 = std::max(1.f - cosine2, 0.f) / std::max(cosine2, 1e-12f);
    return 0.5f * (std::sqrt(1.f + alpha * alpha * tangent2) - 1.f);
}

// Visible normals on a 32 by 32 grid, the weight of each is G2 / G1. The long tail of GGX sits where u1 is near 1:
// u1 = 1 - (1 - t)² puts points there. Both halves of the azimuth are mirror images: one of them is enough.
LobeAlbedo integrateAlbedo(float cosine, float alpha) {
    constexpr int grid = 32;
    const V3f wo(std::sqrt(std::max(0.f, 1.f - cosine * cosine)), 0.f, cosine);
    double flat = 0.0;
    double rising = 0.0;
    for (int i = 0; i < grid; ++i) {
        const float rest = 1.f - (i + 0.5f) / grid;
        for (int j = 0; j < grid; ++j) {
            const V3f h = sampleVisibleNormal(wo, alpha, 1.f - rest * rest, 0.5f * (j + 0.5f) / grid - 0.25f);
            const float c = wo.dot(h);
            const V3f wi = 2.f * c * h - wo;
            if (c > 0.f && wi.z > 0.f) {
                const float weight =
                    2.f * rest * (1.f + lambda(wo, alpha)) / (1.f + lambda(wo, alpha) + lambda(wi, alpha));
                const float s = schlickWeight(c);
                flat += weight * (1.f - s);
                rising += weight * s;
            }
        }
    }
    return {static_cast<float>(flat / (grid * grid)), static_cast<float>(rising / (grid * grid))};
}

float cosineOfNode(float node) {
    const float u = node / (cosineCount - 1);
    return std::max(u * u, 1e-4f);
}

float alphaOfNode(float node) {
    const float v = node / (alphaCount - 1);
    return std::max(v * v, 1e-3f);
}

using Row = std::array<LobeAlbedo, cosineCount>;

Row computeRow(float alphaNode) {
    Row row;
    for (int c = 0; c < cosineCount; ++c) {
        row[c] = integrateAlbedo(cosineOfNode(static_cast<float>(c)), alphaOfNode(alphaNode));
    }
    return row;
}

// What the air's lobe reflects is taken from what it lets through, so the table may say too much but not too little:
// each node is raised by what its four cells lack at their middles, where interpolation is furthest off.
void raise(AlbedoTable& table) {
    const auto exact = table.directional;
    const auto flatOf = [](const LobeAlbedo& albedo) -> float { return albedo.flat; };
    const auto risingOf = [](const LobeAlbedo& albedo) -> float { return albedo.rising; };
    for (int a = 0; a + 1 < alphaCount; ++a) {
        for (int c = 0; c + 1 < cosineCount; ++c) {
            const LobeAlbedo middle = integrateAlbedo(cosineOfNode(c + 0.5f), alphaOfNode(a + 0.5f));
            const auto lack = [&](auto part) {
                const float mean = 0.25f * (part(exact[a][c]) + part(exact[a][c + 1]) + part(exact[a + 1][c]) +
                                            part(exact[a + 1][c + 1]));
                return std::max(part(middle) - mean, 0.f) + quadratureError;
            };
            const float flat = lack(flatOf), rising = lack(risingOf);
            for (int i = 0; i < 2; ++i) {
                for (int j = 0; j < 2; ++j) {
                    LobeAlbedo& node = table.directional[a + i][c + j];
                    node.flat = std::max(node.flat, exact[a + i][c + j].flat + flat);
                    node.rising = std::max(node.rising, exact[a + i][c + j].rising + rising);
                }
            }
        }
    }
}

// 2 ∫ E c dc with c = u² is ∫ 4 u³ E du, and E is linear in u between nodes: no other error than the table's.
LobeAlbedo meanOf(const Row& row) {
    double flat = 0.0;
    double rising = 0.0;
    for (int c = 0; c + 1 < cosineCount; ++c) {
        const double h = 1.0 / (cosineCount - 1), u0 = c * h, u1 = u0 + h;
        const double third = std::pow(u1, 4) - std::pow(u0, 4);
        const double fourth = 0.8 * (std::pow(u1, 5) - std::pow(u0, 5));
        const double right = (fourth - u0 * third) / h, left = third - right;
        flat += left * row[c].flat + right * row[c + 1].flat;
        rising += left * row[c].rising + right * row[c + 1].rising;
    }
    return {static_cast<float>(flat), static_cast<float>(rising)};
}

AlbedoTable computeTable() {
    AlbedoTable table;
    for (int a = 0; a < alphaCount; ++a) {
        table.directional[a] = computeRow(static_cast<float>(a));
    }
    raise(table);
    for (int a = 0; a < alphaCount; ++a) {
        table.mean[a] = meanOf(table.directional[a]);
        table.least[a] = 1.f;
        for (const LobeAlbedo& albedo : table.directional[a]) {
            table.least[a] = std::min(table.least[a], albedo.flat + albedo.rising);
        }
    }
    return table;
}

const AlbedoTable& albedoTable() {
    static const AlbedoTable table = computeTable();
    return table;
}

AlbedoPlace positionOf(float value, int count) {
    const float scaled = std::sqrt(std::clamp(value, 0.f, 1.f)) * (count - 1);
    const int below = std::min(static_cast<int>(scaled), count - 2);
    return {below, scaled - below};
}

float mix(float a, float b, float weight) {
    return a + weight * (b - a);
}

LobeAlbedo mix(const LobeAlbedo& a, const LobeAlbedo& b, float weight) {
    return {mix(a.flat, b.flat, weight), mix(a.rising, b.rising, weight)};
}

} // namespace

float smithMasking(const V3f& direction, float alpha) {
    return 1.f / (1.f + lambda(direction, alpha));
}

float smithVisibility(const V3f& wo, const V3f& wi, float alpha) {
    // cos (1 + 2 lambda) = sqrt(cos² + alpha² sin²), so 4 cos_o cos_i (1 + lambda_o + lambda_i) has no tangent in it.
    const float a2 = alpha * alpha;
    const float o = std::sqrt(wo.z * wo.z + a2 * std::max(1.f - wo.z * wo.z, 0.f));
    const float i = std::sqrt(wi.z * wi.z + a2 * std::max(1.f - wi.z * wi.z, 0.f));
    return 0.5f / std::max(wi.z * o + wo.z * i, 1e-9f);
}

AlbedoPlace albedoColumn(float cosine) {
    return positionOf(cosine, cosineCount);
}

AlbedoPlace albedoRow(float alpha) {
    return positionOf(alpha, alphaCount);
}

LobeAlbedo lobeAlbedo(const AlbedoPlace& column, const AlbedoPlace& row) {
    const AlbedoTable& table = albedoTable();
    const LobeAlbedo* low = table.directional[row.below].data() + column.below;
    const LobeAlbedo* high = table.directional[row.below + 1].data() + column.below;
    return mix(mix(low[0], low[1], column.weight), mix(high[0], high[1], column.weight), row.weight);
}

AlbedoGrid albedoGrid() {
    static_assert(sizeof(LobeAlbedo) == 2 * sizeof(float));
    return {&albedoTable().directional[0][0].flat, cosineCount};
}

LobeAlbedo lobeAlbedo(float cosine, float alpha) {
    return lobeAlbedo(albedoColumn(cosine), albedoRow(alpha));
}

LobeAlbedo meanLobeAlbedo(float alpha) {
    const AlbedoPlace a = positionOf(alpha, alphaCount);
    return mix(albedoTable().mean[a.below], albedoTable().mean[a.below + 1], a.weight);
}

float leastLobeAlbedo(float alpha) {
    const AlbedoPlace a = positionOf(alpha, alphaCount);
    return mix(albedoTable().least[a.below], albedoTable().least[a.below + 1], a.weight);
}

} // namespace patina
