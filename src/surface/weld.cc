#include "surface/weld.h"

#include <cstdint>
#include <cstring>

namespace patina {

using Imath::V3f;

namespace {

std::uint64_t mix(std::uint64_t value) {
    // The finaliser of SplitMix64: every input bit reaches every output bit.
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ull;
    value = (value ^ (value >> 27)) * 0x94d049bb133111ebull;
    return value ^ (value >> 31);
}

std::uint64_t hashOf(const V3f& position) {
    std::uint64_t hash = 0x9e3779b97f4a7c15ull;
    for (int axis = 0; axis < 3; ++axis) {
        const float coordinate = position[axis] + 0.f; // -0 becomes 0
        std::uint32_t bits;
        std::memcpy(&bits, &coordinate, sizeof bits);
        hash = mix(hash ^ bits);
    }
    return hash;
}

} // namespace

std::vector<int> weldedIndices(const std::vector<V3f>& positions) {
    // Open addressing, at most half full.
    std::size_t slots = 16;
    while (slots < 2 * positions.size())
        slots *= 2;
    std::vector<int> table(slots, -1);
    std::vector<int> first(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        std::size_t slot = hashOf(positions[i]) & (slots - 1);
        while (table[slot] >= 0 && positions[table[slot]] != positions[i])
            slot = (slot + 1) & (slots - 1);
        if (table[slot] < 0)
            table[slot] = static_cast<int>(i);
        first[i] = table[slot];
    }
    return first;
}

} // namespace patina
