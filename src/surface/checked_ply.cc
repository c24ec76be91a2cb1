#include "base/errors.h"
#include "surface/checked_file.h"
#include "surface/ply_header.h"
#include "surface/text_scanner.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

namespace patina {

namespace {

bool isIndexList(const PlyProperty& property) {
    return property.isList() && (property.name == "vertex_index" || property.name == "vertex_indices");
}

bool isCoordinate(const PlyProperty& property) {
    return property.name == "x" || property.name == "y" || property.name == "z";
}

/// Properties that OpenMesh reads into fields of its own, not as custom ones.
bool isKnown(const PlyProperty& property) {
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "u", "v", "s", "t", "red", "green", "blue", "diffuse_red",
                             "diffuse_green", "diffuse_blue", "alpha"})
        if (property.name == name)
            return true;
    return false;
}

/// Values one after the other, from text or binary.
class PlyValues {
  public:
    PlyValues(std::string_view body, PlyHeader::Format format) : body_(body), format_(format), words_(body) {}

    std::size_t position() const { return format_ == PlyHeader::Format::text ? words_.position() : at_; }

    enum class Result { good, atEnd, notANumber };
    Result next(const PlyType& type, double& value) {
        if (format_ == PlyHeader::Format::text) {
            const std::string_view word = words_.word();
            if (word.empty())
                return Result::atEnd;
            if (type.real)
                return readNumber(word, value) ? Result::good : Result::notANumber;
            long long integer;
            if (!readInteger(word, integer))
                return Result::notANumber;
            value = static_cast<double>(integer);
            return Result::good;
        }
        if (body_.size() - at_ < static_cast<std::size_t>(type.bytes))
            return Result::atEnd;
        value = decode(type);
        at_ += static_cast<std::size_t>(type.bytes);
        return Result::good;
    }

    /// Skips binary values of which only the number matters; false beyond the end.
    bool skip(std::uint64_t bytes) {
        if (body_.size() - at_ < bytes)
            return false;
        at_ += static_cast<std::size_t>(bytes);
        return true;
    }

  private:
    double decode(const PlyType& type) const {
        std::uint64_t bits = 0;
        for (int i = 0; i < type.bytes; ++i) {
            const int from = format_ == PlyHeader::Format::littleEndian ? type.bytes - 1 - i : i;
            bits = bits << 8 | static_cast<unsigned char>(body_[at_ + static_cast<std::size_t>(from)]);
        }
        if (type.real && type.bytes == 8) {
            double value;
            std::memcpy(&value, &bits, sizeof value);
            return value;
        }
        const auto low = static_cast<std::uint32_t>(bits);
        if (type.real) {
            float value;
            std::memcpy(&value, &low, sizeof value);
            return value;
        }
        if (!type.isSigned)
            return low;
        return type.bytes == 1   ? static_cast<std::int8_t>(low)
               : type.bytes == 2 ? static_cast<std::int16_t>(low)
                                 : static_cast<double>(static_cast<std::int32_t>(low));
    }

    std::string_view body_;
    PlyHeader::Format format_;
    std::size_t at_ = 0;
    TextScanner words_;
};

class PlyChecker {
  public:
    PlyChecker(std::string_view bytes, const std::string& place)
        : place_(place), header_(readPlyHeader(bytes, place)), body_(bytes.substr(header_.bodyStart)),
          values_(body_, header_.format) {}

    CheckedFile check() {
        const PlyElement* vertices = nullptr;
        const PlyElement* faces = nullptr;
        for (const PlyElement& element : header_.elements) {
            if (element.name == "vertex")
                vertices = &element;
            // Strips of triangles, as Stanford's scanning archive has them, stand in for faces.
            if (element.name == "face" || (element.name == "tristrips" && !faces))
                faces = &element;
        }
        if (!vertices || vertices->count == 0)
            throw ModelError(place_, "the model has no vertices", "export it again, as a mesh");
        if (!faces || faces->count == 0)
            throw ModelError(place_, "the model has no faces: it is a cloud of points",
                             "export it as a mesh of triangles or polygons");
        checkElements(*vertices, *faces);
        vertexCount_ = vertices->count;
        const bool strips = faces->name == "tristrips";
        std::string_view vertexBody, faceBody;
        for (const PlyElement& element : header_.elements) {
            const std::size_t start = values_.position();
            if (strips && &element == faces)
                walkStrips(element);
            else
                walk(element);
            const std::string_view part = body_.substr(start, values_.position() - start);
            if (&element == vertices)
                vertexBody = part;
            if (&element == faces)
                faceBody = part;
            if (!vertexBody.empty() && !faceBody.empty())
                break; // what comes later is of no use here
        }
        PlyElement triangles;
        if (strips) {
            triangles.name = "face";
            triangles.count = static_cast<long long>(stripTriangles_.size());
            triangles.properties.push_back(faces->properties[0]);
            triangles.properties[0].countType = PlyType{"uchar", 1, false, false};
            triangles.properties[0].type = PlyType{"int", 4, false, true};
            faces = &triangles;
        }
        CheckedFile out;
        out.binary = header_.format != PlyHeader::Format::text;
        out.vertexCount = static_cast<int>(vertices->count);
        out.faceCount = static_cast<int>(faces->count);
        out.bytes = writeHeader(*vertices, *faces);
        out.bytes.append(vertexBody);
        if (!out.binary)
            out.bytes += '\n';
        if (strips)
            writeTriangles(out.bytes);
        else
            out.bytes.append(faceBody);
        return out;
    }

  private:
    [[noreturn]] void fail(const std::string& message) const {
        throw ModelError(place_, message, "export the model again");
    }

    void checkElements(const PlyElement& vertices, const PlyElement& faces) const {
        int coordinates = 0;
        for (const PlyProperty& property : vertices.properties) {
            if (property.isList())
                fail(fmt::format("vertices have a list, '{}'", property.name));
            if (isCoordinate(property)) {
                ++coordinates;
                if (!property.type.real)
                    fail(fmt::format("the coordinate {} is of type {}, not float", property.name, property.type.name));
            }
        }
        if (coordinates != 3)
            fail("vertices do not have x, y and z");
        if (faces.name == "tristrips" && faces.properties.size() != 1)
            fail("strips of triangles have more than their vertex_indices");
        bool hasIndices = false;
        for (const PlyProperty& property : faces.properties) {
            if (isIndexList(property)) {
                hasIndices = true;
                if (property.type.real || property.type.bytes == 8)
                    fail("faces name their vertices with numbers that are not integers");
            } else if (!hasIndices && property.isList()) {
                fail(fmt::format("the list '{}' stands before the faces' vertex_indices", property.name));
            }
        }
        if (!hasIndices)
            fail("faces have no list vertex_indices");
        for (const PlyElement* element : {&vertices, &faces})
            if (element->count > std::numeric_limits<int>::max())
                fail(fmt::format("{} {} elements are more than can be counted", element->count, element->name));
    }

    double value(const PlyElement& element, long long index, const PlyProperty& property, const PlyType& type) {
        double number = 0.0;
        switch (values_.next(type, number)) {
        case PlyValues::Result::good:
            return number;
        case PlyValues::Result::atEnd:
            throw ModelError(place_, fmt::format("the file ends in {} {} of {}", element.name, index, element.count),
                             "it was cut short: copy or export it again");
        case PlyValues::Result::notANumber:
            break;
        }
        fail(fmt::format("'{}' of {} {} is not {} number", property.name, element.name, index,
                         type.real ? "a" : "a whole"));
    }

    void walk(const PlyElement& element) {
        const bool vertex = element.name == "vertex";
        if (element.properties.empty())
            return;
        for (long long i = 0; i < element.count; ++i)
            for (const PlyProperty& property : element.properties) {
                if (property.isList())
                    walkList(element, i, property);
                else
                    checkNumber(vertex, element, i, property, value(element, i, property, property.type));
            }
    }

    void checkNumber(bool vertex, const PlyElement& element, long long index, const PlyProperty& property,
                     double number) const {
        if (std::isfinite(number) &&
            std::abs(number) <=
                (vertex && isCoordinate(property) ? largestCoordinate : std::numeric_limits<float>::max()))
            return;
        // Normals are computed anew, other elements are not used at all: in binary files whatever they hold is
        // harmless.
        const bool used = vertex && property.name != "nx" && property.name != "ny" && property.name != "nz";
        if (!used && header_.format != PlyHeader::Format::text)
            return;
        throw ModelError(place_,
                         std::isnan(number) ? fmt::format("{} {} has a '{}' that is not a number (nan)", element.name,
                                                          index, property.name)
                                            : fmt::format("{} {} has a '{}' that is infinite or absurdly large",
                                                          element.name, index, property.name),
                         "repair the model where it was made");
    }

    void walkList(const PlyElement& element, long long index, const PlyProperty& property) {
        const double count = value(element, index, property, property.countType);
        const bool indices = element.name == "face" && isIndexList(property);
        if (count < 0 || (indices && count > static_cast<double>(mostCorners)))
            fail(fmt::format("{} {} has {} entries in '{}'", element.name, index, count, property.name));
        if (!indices && header_.format != PlyHeader::Format::text) {
            if (!values_.skip(static_cast<std::uint64_t>(count) * static_cast<std::uint64_t>(property.type.bytes)))
                throw ModelError(place_,
                                 fmt::format("the file ends in {} {} of {}", element.name, index, element.count),
                                 "it was cut short: copy or export it again");
            return;
        }
        for (long long i = 0; i < static_cast<long long>(count); ++i) {
            const double entry = value(element, index, property, property.type);
            if (indices && (entry < 0 || entry >= static_cast<double>(vertexCount_)))
                fail(fmt::format("face {} names vertex {}, but there are {} (from 0)", index, entry, vertexCount_));
            if (!indices)
                checkNumber(false, element, index, property, entry);
        }
    }

    /// Strips lie one behind the other in a single list, each ended by -1 (or in a list each). Every triangle takes the
    /// last two corners of the one before it, so every second one turns the other way.
    void walkStrips(const PlyElement& element) {
        const PlyProperty& property = element.properties[0];
        for (long long i = 0; i < element.count; ++i) {
            const double count = value(element, i, property, property.countType);
            if (count < 0)
                fail(fmt::format("{} {} has {} entries", element.name, i, count));
            std::array<std::int32_t, 2> last{};
            int inStrip = 0;
            for (long long j = 0; j < static_cast<long long>(count); ++j) {
                const double entry = value(element, i, property, property.type);
                if (entry == -1) {
                    inStrip = 0;
                    continue;
                }
                if (entry < 0 || entry >= static_cast<double>(vertexCount_))
                    fail(fmt::format("{} {} names vertex {}, but there are {} (from 0)", element.name, i, entry,
                                     vertexCount_));
                const auto vertex = static_cast<std::int32_t>(entry);
                const bool real = last[0] != last[1] && last[1] != vertex && last[0] != vertex;
                if (inStrip >= 2 && real) {
                    if (inStrip % 2 == 0)
                        stripTriangles_.push_back({last[0], last[1], vertex});
                    else
                        stripTriangles_.push_back({last[1], last[0], vertex});
                }
                last = {last[1], vertex};
                ++inStrip;
            }
        }
    }

    void writeTriangles(std::string& bytes) const {
        for (const std::array<std::int32_t, 3>& triangle : stripTriangles_) {
            if (header_.format == PlyHeader::Format::text) {
                bytes += fmt::format("3 {} {} {}\n", triangle[0], triangle[1], triangle[2]);
                continue;
            }
            bytes.push_back(3);
            for (const std::int32_t vertex : triangle)
                for (int i = 0; i < 4; ++i) {
                    const int shift = header_.format == PlyHeader::Format::littleEndian ? 8 * i : 8 * (3 - i);
                    bytes.push_back(static_cast<char>(static_cast<std::uint32_t>(vertex) >> shift & 0xff));
                }
        }
    }

    std::string writeHeader(const PlyElement& vertices, const PlyElement& faces) const {
        const bool text = header_.format == PlyHeader::Format::text;
        std::string out = fmt::format("ply\nformat {} 1.0\n", text ? "ascii"
                                                              : header_.format == PlyHeader::Format::littleEndian
                                                                  ? "binary_little_endian"
                                                                  : "binary_big_endian");
        for (const PlyElement* element : {&vertices, &faces}) {
            out += fmt::format("element {} {}\n", element->name, element->count);
            for (const PlyProperty& property : element->properties) {
                // In text the reader would take a number of type char for a letter: custom numbers are read as doubles.
                const bool asReal = text && !isIndexList(property) && !(isKnown(property) && !property.isList());
                const char* type = asReal ? "double" : property.type.name;
                if (property.isList())
                    out += fmt::format("property list {} {} {}\n", text ? "int" : countTypeName(property.countType),
                                       type, property.name);
                else
                    out += fmt::format("property {} {}\n", type, property.name);
            }
        }
        return out + "end_header\n";
    }

    /// The reader knows few types for counts; those of the same size serve, since no count is negative.
    static const char* countTypeName(const PlyType& type) {
        return type.bytes == 1 ? "uchar" : type.bytes == 2 ? "uint16" : "int";
    }

    const std::string& place_;
    PlyHeader header_;
    std::string_view body_;
    PlyValues values_;
    long long vertexCount_ = 0;
    std::vector<std::array<std::int32_t, 3>> stripTriangles_;
};

} // namespace

CheckedFile checkedPly(std::string_view bytes, const std::string& place) {
    return PlyChecker(bytes, place).check();
}

} // namespace patina
