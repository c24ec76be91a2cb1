#pragma once
// Content hashes (XXH3, 64 bits): equal bits give equal hashes on every machine of the same byte order.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace patina {

/// Hashes what is added to it, in order.
class ContentHash {
  public:
    ContentHash();
    ~ContentHash();
    ContentHash(ContentHash&&) noexcept;
    ContentHash& operator=(ContentHash&&) noexcept;

    void add(const void* data, std::size_t bytes);
    /// A word and its length, so that ("ab", "c") and ("a", "bc") differ.
    void add(std::string_view word);

    std::uint64_t digest() const;
    /// The digest as 16 hexadecimal digits.
    std::string text() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace patina
