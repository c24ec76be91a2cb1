#include "base/random.h"

#include "base/hash.h"

#include <Random123/philox.h>

namespace patina {

KeyedRandom::KeyedRandom(std::uint64_t seed, std::string_view label, std::string_view purpose) {
    ContentHash hash;
    hash.add(&seed, sizeof seed);
    hash.add(label);
    hash.add(purpose);
    const std::uint64_t digest = hash.digest();
    key_ = {static_cast<std::uint32_t>(digest), static_cast<std::uint32_t>(digest >> 32)};
}

std::array<std::uint32_t, 4> KeyedRandom::words(std::uint32_t event, std::int32_t x, std::int32_t y,
                                                std::int32_t z) const {
    using Generator = r123::Philox4x32;
    const Generator::ctr_type counter = {
        {event, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(z)}};
    const Generator::key_type key = {{key_[0], key_[1]}};
    const Generator::ctr_type out = Generator()(counter, key);
    return {out[0], out[1], out[2], out[3]};
}

std::array<double, 4> KeyedRandom::uniforms(std::uint32_t event, std::int32_t x, std::int32_t y, std::int32_t z) const {
    const auto w = words(event, x, y, z);
    return {uniformFromWord(w[0]), uniformFromWord(w[1]), uniformFromWord(w[2]), uniformFromWord(w[3])};
}

} // namespace patina
