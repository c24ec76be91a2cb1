#include "surface/ply_header.h"

#include "base/errors.h"
#include "surface/text_scanner.h"

#include <fmt/format.h>

namespace patina {

namespace {

struct TypeName {
    std::string_view name;
    PlyType type;
};

constexpr PlyType int8{"char", 1, false, true}, uint8{"uchar", 1, false, false}, int16{"short", 2, false, true},
    uint16{"ushort", 2, false, false}, int32{"int", 4, false, true}, uint32{"uint", 4, false, false},
    float32{"float", 4, true, true}, float64{"double", 8, true, true};

constexpr TypeName typeNames[] = {{"char", int8},     {"int8", int8},       {"uchar", uint8},    {"uint8", uint8},
                                  {"short", int16},   {"int16", int16},     {"ushort", uint16},  {"uint16", uint16},
                                  {"int", int32},     {"int32", int32},     {"uint", uint32},    {"uint32", uint32},
                                  {"float", float32}, {"float32", float32}, {"double", float64}, {"float64", float64}};

} // namespace

PlyHeader readPlyHeader(std::string_view bytes, const std::string& place) {
    TextScanner scanner(bytes);
    int line = 1;
    if (scanner.line() != "ply" && bytes.substr(0, 3) != "PLY")
        throw ModelError(place, "this is not a PLY file: it does not begin with ply",
                         "export the model again, as PLY, OBJ, STL or OFF");
    const auto fail = [&](const std::string& message) {
        throw ModelError(SourcePlace{place, line, 0}.text(), message, "export the model again");
    };
    const auto type = [&](std::string_view name) {
        for (const TypeName& candidate : typeNames)
            if (candidate.name == name)
                return candidate.type;
        fail(fmt::format("'{}' is not a type of PLY", name.substr(0, 40)));
        return PlyType{};
    };

    PlyHeader header;
    bool hasFormat = false;
    for (;;) {
        if (scanner.atEnd())
            throw ModelError(place, "the file ends in its header, before end_header",
                             "it was cut short: copy or export it again");
        const std::string_view text = scanner.line();
        ++line;
        TextScanner words(text);
        const std::string_view keyword = words.word();
        if (keyword == "end_header")
            break;
        if (keyword == "format") {
            const std::string_view format = words.word();
            hasFormat = true;
            if (format == "ascii")
                header.format = PlyHeader::Format::text;
            else if (format == "binary_little_endian")
                header.format = PlyHeader::Format::littleEndian;
            else if (format == "binary_big_endian")
                header.format = PlyHeader::Format::bigEndian;
            else
                fail(fmt::format("unknown PLY format '{}'", format.substr(0, 40)));
        } else if (keyword == "element") {
            PlyElement element;
            element.name = words.word();
            if (!readInteger(words.word(), element.count) || element.count < 0)
                fail(fmt::format("element '{}' has no number", element.name.substr(0, 40)));
            for (const PlyElement& other : header.elements)
                if (other.name == element.name)
                    fail(fmt::format("element '{}' occurs twice", element.name.substr(0, 40)));
            header.elements.push_back(std::move(element));
        } else if (keyword == "property") {
            if (header.elements.empty())
                fail("a property stands before the first element");
            PlyProperty property;
            std::string_view word = words.word();
            if (word == "list") {
                property.countType = type(words.word());
                if (property.countType.real)
                    fail("a list is counted with a type that is not an integer");
                word = words.word();
            }
            property.type = type(word);
            property.name = words.word();
            if (property.name.empty())
                fail("a property has no name");
            for (const PlyProperty& other : header.elements.back().properties)
                if (other.name == property.name)
                    fail(fmt::format("property '{}' occurs twice", property.name.substr(0, 40)));
            header.elements.back().properties.push_back(std::move(property));
        } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
            fail(fmt::format("'{}' has no meaning in a PLY header", keyword.substr(0, 40)));
        }
    }
    if (!hasFormat)
        fail("the PLY header does not say its format");
    header.bodyStart = scanner.position();
    return header;
}

} // namespace patina
