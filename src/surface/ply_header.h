#pragma once
// The header of a PLY file.

#include <string>
#include <string_view>
#include <vector>

namespace patina {

/// A scalar type of PLY under the name that every reader knows, and its size in bytes.
struct PlyType {
    const char* name = nullptr;
    int bytes = 0;
    bool real = false;
    bool isSigned = false;
};

struct PlyProperty {
    std::string name;
    PlyType type;
    PlyType countType; ///< of lists; no name: a single value
    bool isList() const { return countType.name != nullptr; }
};

struct PlyElement {
    std::string name;
    long long count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    enum class Format { text, littleEndian, bigEndian };
    Format format = Format::text;
    std::vector<PlyElement> elements;
    std::size_t bodyStart = 0;
};

/// \throws ModelError where it is not one.
PlyHeader readPlyHeader(std::string_view bytes, const std::string& place);

} // namespace patina
