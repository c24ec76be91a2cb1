#include "base/hash.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <new>

namespace patina {

struct ContentHash::State {
    XXH3_state_t* xxh = XXH3_createState();
    State() {
        if (!xxh)
            throw std::bad_alloc();
        XXH3_64bits_reset(xxh);
    }
    ~State() { XXH3_freeState(xxh); }
    State(const State&) = delete;
    State& operator=(const State&) = delete;
};

ContentHash::ContentHash() : state_(std::make_unique<State>()) {}
ContentHash::~ContentHash() = default;
ContentHash::ContentHash(ContentHash&&) noexcept = default;
ContentHash& ContentHash::operator=(ContentHash&&) noexcept = default;

void ContentHash::add(const void* data, std::size_t bytes) {
    XXH3_64bits_update(state_->xxh, data, bytes);
}

void ContentHash::add(std::string_view word) {
    const std::uint64_t size = word.size();
    add(&size, sizeof size);
    add(word.data(), word.size());
}

std::uint64_t ContentHash::digest() const {
    return XXH3_64bits_digest(state_->xxh);
}

std::string ContentHash::text() const {
    return fmt::format("{:016x}", digest());
}

} // namespace patina
