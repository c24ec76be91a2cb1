#include "operators/growth/arrival_clock.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

namespace patina {

namespace {

constexpr std::uint32_t mostArrivals = 31;     // a Poisson variate of mean 3 exceeds it once in 1e21 draws
constexpr std::uint32_t eventsPerInterval = 8; // blocks of four words: 1 + 3 arrivals, then 4 each
constexpr std::uint32_t countEvents = 0x80000000u;

/// Poisson variate of mean -log(none) by inversion.
std::uint32_t poisson(double uniform, double none, double mean) {
    static constexpr std::array<double, mostArrivals + 1> inverse = [] {
        std::array<double, mostArrivals + 1> table{};
        for (std::uint32_t n = 1; n <= mostArrivals; ++n)
            table[n] = 1.0 / n;
        return table;
    }();
    std::uint32_t n = 0;
    double probability = none;
    for (double sum = none; uniform > sum && n < mostArrivals; sum += probability)
        probability *= mean * inverse[++n];
    return n;
}

/// The same for mean 1, in integers and almost without branches: how many of the thresholds 2^32 P(count <= n) a word
/// has passed.
std::uint32_t poissonOfOne(std::uint32_t word) {
    static constexpr std::array<std::uint32_t, 12> thresholds = [] {
        std::array<std::uint32_t, 12> table{};
        double probability = 0.36787944117144233, sum = 0.0; // 1/e
        for (int n = 0; n < 12; ++n) {
            sum += probability;
            probability /= n + 1;
            table[n] = static_cast<std::uint32_t>(sum * 4294967296.0 - 0.5);
        }
        return table;
    }();
    std::uint32_t n = 0;
    for (int i = 0; i < 5; ++i)
        n += word > thresholds[i];
    if (n == 5)
        for (int i = 5; i < 12; ++i)
            n += word > thresholds[i];
    return n;
}

} // namespace

ArrivalClock::ArrivalClock(const GrowthLattice& lattice, const KeyedRandom& clock, const KeyedRandom& thinning,
                           Rate rate, const std::vector<float>& arrival)
    : lattice_(lattice), clock_(clock), thinning_(thinning), arrival_(arrival) {
    const bool uniform = rate == Rate::perCell || std::all_of(lattice.areas.begin(), lattice.areas.end(),
                                                              [](float area) { return area == 1.f; });
    if (!uniform) {
        noArrival_.resize(lattice.size());
        for (std::size_t i = 0; i < lattice.size(); ++i)
            noArrival_[i] = static_cast<float>(std::exp(-double(lattice.areas[i])));
    }
}

std::uint32_t ArrivalClock::draw(std::size_t cell, std::uint32_t word) const {
    return noArrival_.empty() ? poissonOfOne(word)
                              : poisson(uniformFromWord(word), noArrival_[cell], lattice_.areas[cell]);
}

template <class Visit>
void ArrivalClock::visit(std::size_t cell, std::uint32_t interval, std::uint64_t end, Visit&& visit) const {
    const Imath::V3i& key = lattice_.keys[cell];
    auto words = clock_.words(interval * eventsPerInterval, key.x, key.y, key.z);
    const std::uint32_t count = draw(cell, words[0]);
    std::array<std::uint32_t, 4> dice{};
    for (std::uint32_t n = 0; n < count; ++n) {
        const std::uint32_t word = n + 1; // word 0 of the first block was the count
        if (word % 4 == 0)
            words = clock_.words(interval * eventsPerInterval + word / 4, key.x, key.y, key.z);
        if (!arrival_.empty()) {
            if (n % 4 == 0)
                dice = thinning_.words(interval * eventsPerInterval + n / 4, key.x, key.y, key.z);
            if (uniformFromWord(dice[n % 4]) >= arrival_[cell])
                continue;
        }
        if (words[word % 4] < end)
            visit(words[word % 4]);
    }
}

std::uint32_t ArrivalClock::count(std::size_t cell, double age) const {
    const Imath::V3i& key = lattice_.keys[cell];
    const auto whole = static_cast<std::uint32_t>(age);
    const auto end = static_cast<std::uint64_t>((age - whole) * 4294967296.0);
    const std::uint32_t intervals = whole + (end > 0);
    std::array<std::uint32_t, 4> counts{}, times{}, dice{};
    std::uint32_t total = 0;
    for (std::uint32_t i = 0; i < intervals; ++i) {
        if (i % 4 == 0) // one block of words tells the counts of four intervals
            counts = clock_.words(countEvents + i / 4, key.x, key.y, key.z);
        const std::uint32_t count = draw(cell, counts[i % 4]);
        if (i < whole && arrival_.empty()) {
            total += count;
            continue;
        }
        for (std::uint32_t n = 0; n < count; ++n) {
            if (n % 4 == 0) {
                times = clock_.words(i * eventsPerInterval + n / 4, key.x, key.y, key.z);
                if (!arrival_.empty())
                    dice = thinning_.words(i * eventsPerInterval + n / 4, key.x, key.y, key.z);
            }
            const bool lands = arrival_.empty() || uniformFromWord(dice[n % 4]) < arrival_[cell];
            total += lands && (i < whole || times[n % 4] < end);
        }
    }
    return total;
}

void ArrivalClock::interval(std::uint32_t interval, double end, std::vector<Arrival>& arrivals) const {
    // A bucket sort by time: about 16 arrivals to a bucket, which are then sorted by (time, cell). Cells are drawn in a
    // fixed number of ranges, each with counters of its own.
    const std::size_t cells = lattice_.size();
    int bits = 0;
    while (bits < 24 && (cells >> (bits + 4)) > 0)
        ++bits;
    const std::size_t buckets = std::size_t(1) << bits;
    const int shift = 32 - bits;
    const auto bucketOf = [shift](Arrival a) { return std::size_t(a >> 32) >> shift; };
    const auto endWord = static_cast<std::uint64_t>(end * 4294967296.0);

    constexpr std::size_t mostRanges = 16;
    const std::size_t ranges = std::clamp<std::size_t>(cells / 4096, 1, mostRanges);
    std::vector<std::vector<Arrival>> drawn(ranges);
    std::vector<std::vector<std::uint32_t>> places(ranges);
    tbb::parallel_for(std::size_t(0), ranges, [&](std::size_t r) {
        const std::size_t first = cells * r / ranges, last = cells * (r + 1) / ranges;
        places[r].assign(buckets, 0);
        drawn[r].reserve((last - first) * 9 / 8 + 64);
        for (std::size_t cell = first; cell < last; ++cell) {
            visit(cell, interval, endWord, [&](std::uint32_t time) {
                drawn[r].push_back((std::uint64_t(time) << 32) | cell);
                ++places[r][bucketOf(drawn[r].back())];
            });
        }
    });
    std::vector<std::uint32_t> starts(buckets + 1);
    std::uint32_t total = 0;
    for (std::size_t b = 0; b < buckets; ++b) {
        starts[b] = total;
        for (std::size_t r = 0; r < ranges; ++r) {
            const std::uint32_t count = places[r][b];
            places[r][b] = total;
            total += count;
        }
    }
    starts[buckets] = total;
    arrivals.resize(total);
    tbb::parallel_for(std::size_t(0), ranges, [&](std::size_t r) {
        for (const Arrival a : drawn[r])
            arrivals[places[r][bucketOf(a)]++] = a;
    });
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, buckets, 256), [&](const auto& range) {
        for (std::size_t b = range.begin(); b < range.end(); ++b)
            std::sort(arrivals.begin() + starts[b], arrivals.begin() + starts[b + 1]);
    });
}

} // namespace patina
