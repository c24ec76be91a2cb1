#include "render/light_tables.h"

#include "base/lane_kernel.h"
#include "base/turns.h"

#include <algorithm>

namespace patina {

namespace {

constexpr float pi = float(M_PI);
constexpr int rows = LightTables::rows, columns = LightTables::columns;
constexpr float cellsPerSteradian = float(rows * columns / (4.0 * M_PI));
constexpr int normalsAround = 18, normalsDown = 10;
constexpr int group = 16;
constexpr int groups = 16;    // of a row of sums; those that are not there end `beyond`
constexpr float beyond = 2.f; // above every number that is looked for

// Appends the running sums of `count` weights, over their total, and those that end groups.
void appendEnds(std::vector<float>& ends, std::vector<float>& groupEnds, const std::vector<double>& weights) {
    const auto count = int(weights.size());
    double total = 0.0;
    for (const double weight : weights)
        total += weight;
    double running = 0.0;
    for (int i = 0; i < count; ++i) {
        running += weights[std::size_t(i)];
        ends.push_back(i + 1 < count && total > 0.0 ? float(running / total) : 1.f);
        if (i % group == group - 1)
            groupEnds.push_back(i + 1 < count ? ends.back() : beyond);
    }
    groupEnds.insert(groupEnds.end(), std::size_t(groups - count / group), beyond);
}

PATINA_LANE_BODY int within(int i, int last) {
    const int least = i < 0 ? 0 : i;
    return least < last ? least : last;
}

struct Choice {
    int entry;
    float place;  // of the number within the entry, 0…1
    float chance; // of the entry
};

PATINA_LANE_BODY void descend(const float* sums, int step, float u, int& at, float& below) {
    const float sum = sums[at + step - 1];
    below = sum <= u ? sum : below;
    at += sum <= u ? step : 0;
}

// How many of the 15 sums from `from` on are not above u, and the last of them.
PATINA_LANE_BODY int search(const float* sums, int from, float u, float& below) {
    int at = from;
    descend(sums, 8, u, at, below);
    descend(sums, 4, u, at, below);
    descend(sums, 2, u, at, below);
    descend(sums, 1, u, at, below);
    return at - from;
}

// The entry that a number in [0, 1) falls into.
PATINA_LANE_BODY Choice choose(const float* groupEnds, int groupsAt, const float* ends, int endsAt, float u) {
    float below = 0.f;
    const int first = search(groupEnds, groupsAt, u, below) * group;
    const int entry = first + search(ends, endsAt + first, u, below);
    const float width = ends[endsAt + entry] - below;
    const float place = (u - below) / (width > 0.f ? width : 1.f);
    const float inside = place < 0.f ? 0.f : 0.999999f < place ? 0.999999f : place;
    return {entry, width > 0.f ? inside : 0.5f, width};
}

// Of the upright frame.
struct Direction {
    float x, y, z;
};

PATINA_LANE_BODY Direction directionOf(int row, int column, float down, float across) {
    const float z = 2.f * (float(row) + down) / rows - 1.f, r2 = 1.f - z * z;
    const CirclePoint around = circlePoint((float(column) + across) / columns);
    const float r = std::sqrt(r2 > 0.f ? r2 : 0.f);
    return {r * around.cosine, r * around.sine, z};
}

PATINA_LANE_BODY void sampleOne(const LightTables::View& tables, int table, float u, float v, float& x, float& y,
                                float& z, float& density) {
    const Choice row = choose(tables.rowGroupEnds, table * groups, tables.rowEnds, table * rows, v);
    const int line = table * rows + row.entry;
    const Choice column = choose(tables.columnGroupEnds, line * groups, tables.columnEnds, line * columns, u);
    const Direction d = directionOf(row.entry, column.entry, row.place, column.place);
    const Frame& frame = tables.frame;
    x = frame.tangent.x * d.x + frame.bitangent.x * d.y + frame.normal.x * d.z;
    y = frame.tangent.y * d.x + frame.bitangent.y * d.y + frame.normal.y * d.z;
    z = frame.tangent.z * d.x + frame.bitangent.z * d.y + frame.normal.z * d.z;
    density = row.chance * column.chance * cellsPerSteradian;
}

PATINA_LANE_BODY float densityOne(const LightTables::View& tables, int table, float x, float y, float z) {
    const Frame& frame = tables.frame;
    const float dx = x * frame.tangent.x + y * frame.tangent.y + z * frame.tangent.z;
    const float dy = x * frame.bitangent.x + y * frame.bitangent.y + z * frame.bitangent.z;
    const float dz = x * frame.normal.x + y * frame.normal.y + z * frame.normal.z;
    const int row = within(int(0.5f * (dz + 1.f) * rows), rows - 1);
    const float signedTurn = turnOf(dx, dy), turn = signedTurn < 0.f ? signedTurn + 1.f : signedTurn;
    const int column = within(int(turn * columns), columns - 1);
    const int line = table * rows + row, cell = line * columns + column;
    // The sum before the first of a line is 0.
    const float rowBelow = tables.rowEnds[row > 0 ? line - 1 : line];
    const float columnBelow = tables.columnEnds[column > 0 ? cell - 1 : cell];
    const float ofRow = tables.rowEnds[line] - (row > 0 ? rowBelow : 0.f);
    const float ofColumn = tables.columnEnds[cell] - (column > 0 ? columnBelow : 0.f);
    return ofRow * ofColumn * cellsPerSteradian;
}

PATINA_LANE_BODY int aimOne(const Frame& frame, float x, float y, float z) {
    const float nx = x * frame.tangent.x + y * frame.tangent.y + z * frame.tangent.z;
    const float ny = x * frame.bitangent.x + y * frame.bitangent.y + z * frame.bitangent.z;
    const float nz = x * frame.normal.x + y * frame.normal.y + z * frame.normal.z;
    const int down = within(int(halfTurnsOfCosine(nz) * (normalsDown - 1) + 0.5f), normalsDown - 1);
    const int around = within(int((turnOf(nx, ny) + 1.f) * normalsAround + 0.5f), 2 * normalsAround - 1);
    return down * normalsAround + (around < normalsAround ? around : around - normalsAround);
}

std::size_t rounded(std::size_t lanes) {
    return (lanes + 15) / 16 * 16;
}

struct Sampling {
    const LightTables::View& tables;
    const LightTables::SampleLanes& lanes;
};
PATINA_LANE_BODY void sampleTablesBody(const Sampling& sampling) {
    const LightTables::SampleLanes& lanes = sampling.lanes;
    const LightTables::View tables = sampling.tables;
    const Vectors direction = lanes.direction;
    const int* table = lanes.table;
    const float *u = lanes.u, *v = lanes.v;
    float* density = lanes.density;
    const std::size_t count = rounded(lanes.count);
    PATINA_LANES
    for (std::size_t i = 0; i < count; ++i)
        sampleOne(tables, table[i], u[i], v[i], direction.x[i], direction.y[i], direction.z[i], density[i]);
}
PATINA_LANE_KERNEL(sampleTables, Sampling)

struct Densities {
    const LightTables::View& tables;
    const LightTables::DensityLanes& lanes;
};
PATINA_LANE_BODY void densityOfTablesBody(const Densities& densities) {
    const LightTables::DensityLanes& lanes = densities.lanes;
    const LightTables::View tables = densities.tables;
    const ConstVectors direction = lanes.direction;
    const int* table = lanes.table;
    float* density = lanes.density;
    const std::size_t count = rounded(lanes.count);
    PATINA_LANES
    for (std::size_t i = 0; i < count; ++i)
        density[i] = densityOne(tables, table[i], direction.x[i], direction.y[i], direction.z[i]);
}
PATINA_LANE_KERNEL(densityOfTables, Densities)

struct Aiming {
    const Frame& frame;
    const LightTables::AimLanes& lanes;
};
PATINA_LANE_BODY void aimTablesBody(const Aiming& aiming) {
    const LightTables::AimLanes& lanes = aiming.lanes;
    const Frame frame = aiming.frame;
    const ConstVectors normal = lanes.normal;
    int* table = lanes.table;
    const std::size_t count = rounded(lanes.count);
    PATINA_LANES
    for (std::size_t i = 0; i < count; ++i)
        table[i] = aimOne(frame, normal.x[i], normal.y[i], normal.z[i]);
}
PATINA_LANE_KERNEL(aimTables, Aiming)

} // namespace

LightTables::LightTables(const std::vector<float>& luminances, const Frame& frame, bool skyOnly) : frame_(frame) {
    for (int i = 0; i < normalsDown * normalsAround; ++i) {
        const float theta = pi * float(i / normalsAround) / (normalsDown - 1);
        const float phi = 2.f * pi * float(i % normalsAround) / normalsAround;
        append(luminances, {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)},
               skyOnly);
    }
}

void LightTables::append(const std::vector<float>& luminances, const Imath::V3f& normal, bool skyOnly) {
    std::vector<double> rowWeights, weights(columns);
    for (int row = 0; row < rows; ++row) {
        const float z = 2.f * (float(row) + 0.5f) / rows - 1.f;
        const float r = std::sqrt(1.f - z * z);
        double sum = 0.0;
        for (int column = 0; column < columns; ++column) {
            const float phi = 2.f * pi * (float(column) + 0.5f) / columns;
            const Imath::V3f direction(r * std::cos(phi), r * std::sin(phi), z);
            // The true normal may be 14 degrees off the table's: what the table takes to be below it keeps a little.
            const double cosine = std::max(direction ^ normal, 0.f) + 0.04f;
            double& weight = weights[std::size_t(column)];
            weight = skyOnly && z < 0.f ? 0.0 : luminances[std::size_t(row) * columns + std::size_t(column)] * cosine;
            sum += weight;
        }
        appendEnds(columnEnds_, columnGroupEnds_, weights);
        rowWeights.push_back(sum);
    }
    appendEnds(rowEnds_, rowGroupEnds_, rowWeights);
}

LightTables::View LightTables::view() const {
    return {rowGroupEnds_.data(), rowEnds_.data(), columnGroupEnds_.data(), columnEnds_.data(), frame_};
}

Imath::V3f LightTables::cellDirection(int row, int column, float down, float across) {
    const Direction d = directionOf(row, column, down, across);
    return {d.x, d.y, d.z};
}

int LightTables::tableFor(const Imath::V3f& normal) const {
    return aimOne(frame_, normal.x, normal.y, normal.z);
}

LightTables::Sample LightTables::sample(int table, const Imath::V2f& position) const {
    Sample sample{};
    sampleOne(view(), table, position.x, position.y, sample.direction.x, sample.direction.y, sample.direction.z,
              sample.pdf);
    return sample;
}

float LightTables::density(int table, const Imath::V3f& direction) const {
    return densityOne(view(), table, direction.x, direction.y, direction.z);
}

void LightTables::aim(const AimLanes& lanes) const {
    aimTables({frame_, lanes});
}

void LightTables::sample(const SampleLanes& lanes) const {
    sampleTables({view(), lanes});
}

void LightTables::density(const DensityLanes& lanes) const {
    densityOfTables({view(), lanes});
}

} // namespace patina
