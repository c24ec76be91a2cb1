#include "base/errors.h"
#include "surface/checked_file.h"
#include "surface/text_scanner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace patina {

namespace {

struct Corner {
    long long vertex;
    long long uv; ///< 0: none
    long long number;
};

/// One pass over the lines; faces may name vertices that come later, so their range is checked at the end.
class ObjChecker {
  public:
    ObjChecker(std::string_view bytes, const std::string& file) : scanner_(bytes), file_(file) {}

    CheckedFile check() {
        while (!scanner_.atEnd())
            takeStatement(nextStatement());
        checkRanges();
        checkSharp();
        writeFaces();
        out_.vertexCount = static_cast<int>(vertices_);
        out_.faceCount = faces_;
        return std::move(out_);
    }

  private:
    struct Face {
        int line;
        int number;
        std::size_t start;
        int size;
    };

    struct Sharp {
        int line;
        long long a, b; ///< the same: a corner
        float sharpness;
    };

    [[noreturn]] void fail(int line, const std::string& message, const std::string& remedy = {}) const {
        throw ModelError(SourcePlace{file_, line, 0}.text(), message, remedy);
    }

    /// A line, joined with those after it while it ends in a backslash.
    std::string_view nextStatement() {
        std::string_view text = scanner_.line();
        statementLine_ = ++line_;
        if (text.empty() || text.back() != '\\')
            return text;
        joined_.clear();
        while (!text.empty() && text.back() == '\\') {
            joined_.append(text.substr(0, text.size() - 1)).push_back(' ');
            if (scanner_.atEnd())
                return joined_;
            text = scanner_.line();
            ++line_;
        }
        joined_.append(text);
        return joined_;
    }

    void takeStatement(std::string_view text) {
        TextScanner words(text);
        const std::string_view keyword = words.word();
        if (keyword == "v")
            takeVertex(words);
        else if (keyword == "vt")
            takeUv(words);
        else if (keyword == "f" || keyword == "fo")
            takeFace(words);
        else if (keyword == "t")
            takeTag(words);
    }

    /// "t crease 2/1/0 4 7 2.5", "t corner 1/1/0 4 10": OpenSubdiv's tags; so many whole numbers (vertices, counted
    /// from 0), numbers and words follow. Of several edges or vertices each has a sharpness of its own, or all the
    /// same. Other tags choose rules of subdivision, which are not the model's to choose here.
    void takeTag(TextScanner& words) {
        const std::string_view kind = words.word();
        const int step = kind == "crease" ? 2 : kind == "corner" ? 1 : 0;
        if (step == 0)
            return;
        const auto bad = [&] {
            fail(statementLine_, fmt::format("this is no {}", kind),
                 step == 2 ? "creases are written as t crease 2/1/0 VERTEX VERTEX SHARPNESS, vertices counted from 0"
                           : "sharp corners are written as t corner 1/1/0 VERTEX SHARPNESS, vertices counted from 0");
        };
        const std::string_view counts = words.word();
        const std::size_t slash = counts.find('/');
        long long wholes = 0, numbers = 0;
        if (slash == std::string_view::npos || !readInteger(counts.substr(0, slash), wholes) ||
            !readInteger(counts.substr(slash + 1, counts.find('/', slash + 1) - slash - 1), numbers) || wholes < step ||
            wholes % step != 0 || wholes > mostCorners || (numbers != 1 && numbers != wholes / step))
            bad();
        std::vector<long long> vertices(static_cast<std::size_t>(wholes));
        for (long long& vertex : vertices)
            if (!readInteger(words.word(), vertex) || vertex < 0)
                bad();
        float sharpness = 0.f;
        for (long long i = 0; i < wholes / step; ++i) {
            if (i < numbers) {
                double value = 0.0;
                if (!readNumber(words.word(), value) || !(value >= 0.0)) // false for NaN
                    bad();
                sharpness = static_cast<float>(std::min(value, 10.0));
            }
            if (step == 2 && vertices[2 * i] == vertices[2 * i + 1])
                bad();
            sharp_.push_back({statementLine_, vertices[step * i], vertices[step * i + step - 1], sharpness});
        }
    }

    double number(std::string_view word, std::string_view what, long long which) const {
        double value;
        if (!readNumber(word, value))
            fail(statementLine_,
                 word.empty() ? fmt::format("{} {} has too few numbers", what, which)
                              : fmt::format("{} {} has '{}' where a number should be", what, which, word.substr(0, 40)),
                 "export the model again");
        if (!std::isfinite(value) || std::abs(value) > largestCoordinate)
            fail(statementLine_,
                 std::isnan(value) ? fmt::format("{} {} is not a number (nan)", what, which)
                                   : fmt::format("{} {} is infinite or absurdly far away", what, which),
                 "repair the model where it was made");
        return value;
    }

    void takeVertex(TextScanner& words) {
        ++vertices_;
        double values[6];
        for (int i = 0; i < 3; ++i)
            values[i] = number(words.word(), "vertex", vertices_);
        out_.bytes += fmt::format("v {} {} {}", static_cast<float>(values[0]), static_cast<float>(values[1]),
                                  static_cast<float>(values[2]));
        int colours = 0;
        for (; colours < 3; ++colours)
            if (!readNumber(words.word(), values[3 + colours]) || !std::isfinite(values[3 + colours]))
                break;
        // Colours count by vertex only if every vertex has one: those before lack it otherwise.
        if (colours == 3 && coloured_ + 1 == vertices_) {
            ++coloured_;
            out_.bytes += fmt::format(" {} {} {}", static_cast<float>(values[3]), static_cast<float>(values[4]),
                                      static_cast<float>(values[5]));
        }
        out_.bytes += '\n';
    }

    void takeUv(TextScanner& words) {
        ++uvs_;
        const double u = number(words.word(), "texture coordinate", uvs_);
        const std::string_view second = words.word();
        const double v = second.empty() ? 0.0 : number(second, "texture coordinate", uvs_);
        out_.bytes += fmt::format("vt {} {}\n", static_cast<float>(u), static_cast<float>(v));
    }

    /// "7", "7/3", "7//2", "7/3/2", each number possibly counted back from the last one (negative).
    Corner takeCorner(std::string_view word) const {
        const auto bad = [&] {
            fail(statementLine_, fmt::format("'{}' is not a corner of a face", word.substr(0, 40)),
                 "corners are written as 7, 7/3, 7//2 or 7/3/2");
        };
        Corner corner{0, 0, 0};
        std::string_view rest = word;
        const std::size_t slash = rest.find('/');
        if (!readInteger(rest.substr(0, slash), corner.vertex))
            bad();
        if (slash != std::string_view::npos) {
            rest.remove_prefix(slash + 1);
            const std::string_view uv = rest.substr(0, rest.find('/'));
            if (!uv.empty() && !readInteger(uv, corner.uv))
                bad();
            if (!uv.empty() && corner.uv == 0)
                bad();
        }
        corner.number = corner.vertex;
        if (corner.vertex < 0)
            corner.vertex += vertices_ + 1;
        if (corner.uv < 0) {
            corner.uv += uvs_ + 1;
            if (corner.uv < 1)
                fail(statementLine_, fmt::format("face {} names a texture coordinate before the first", faces_),
                     "export the model again");
        }
        return corner;
    }

    void takeFace(TextScanner& words) {
        ++faces_;
        Face face{statementLine_, faces_, corners_.size(), 0};
        for (std::string_view word = words.word(); !word.empty(); word = words.word()) {
            if (word[0] == '#')
                break;
            const Corner corner = takeCorner(word);
            ++face.size;
            corners_.push_back(corner);
        }
        if (face.size > mostCorners)
            fail(statementLine_, fmt::format("face {} has {} corners", faces_, face.size), "cut it into smaller faces");
        faceList_.push_back(face);
    }

    void checkRanges() const {
        if (vertices_ > std::numeric_limits<int>::max() || uvs_ > std::numeric_limits<int>::max())
            throw ModelError(file_, "the model has more vertices than can be counted");
        for (const Face& face : faceList_)
            for (int i = 0; i < face.size; ++i) {
                const Corner& corner = corners_[face.start + i];
                if (corner.vertex < 1 || corner.vertex > vertices_)
                    fail(
                        face.line,
                        fmt::format("face {} names vertex {}, but there are {}", face.number, corner.number, vertices_),
                        "export the model again");
                if (corner.uv > uvs_)
                    fail(face.line,
                         fmt::format("face {} names texture coordinate {}, but there are {}", face.number, corner.uv,
                                     uvs_),
                         "export the model again");
            }
    }

    /// Creases lie on edges, and corners on vertices, that there are.
    void checkSharp() {
        if (sharp_.empty())
            return;
        std::vector<std::pair<long long, long long>> edges;
        for (const Face& face : faceList_)
            for (int i = 0; i < face.size; ++i)
                edges.push_back(std::minmax(corners_[face.start + i].vertex - 1,
                                            corners_[face.start + (i + 1) % face.size].vertex - 1));
        std::sort(edges.begin(), edges.end());
        for (const Sharp& sharp : sharp_) {
            if (std::max(sharp.a, sharp.b) >= vertices_)
                fail(sharp.line, fmt::format("vertex {} is sharp, but there are {}, counted from 0",
                                             std::max(sharp.a, sharp.b), vertices_));
            const int a = static_cast<int>(sharp.a), b = static_cast<int>(sharp.b);
            if (sharp.a == sharp.b) {
                out_.corners.push_back({a, sharp.sharpness});
                continue;
            }
            const std::pair<long long, long long> edge = std::minmax(sharp.a, sharp.b);
            if (!std::binary_search(edges.begin(), edges.end(), edge))
                fail(sharp.line,
                     fmt::format("there is no edge between the vertices {} and {} (counted from 0)", sharp.a, sharp.b),
                     "creases lie on edges of the faces");
            out_.creases.push_back({a, b, sharp.sharpness});
        }
    }

    /// A vertex counts once in a face: OpenMesh drops repeated ones too, but not their UVs.
    void writeFaces() {
        std::vector<long long> seen(static_cast<std::size_t>(vertices_) + 1, -1);
        std::vector<Corner> kept;
        long long key = 0;
        for (const Face& face : faceList_) {
            ++key;
            kept.clear();
            bool hasUvs = true;
            for (int i = 0; i < face.size; ++i) {
                const Corner& corner = corners_[face.start + i];
                if (seen[corner.vertex] == key)
                    continue;
                seen[corner.vertex] = key;
                hasUvs = hasUvs && corner.uv > 0;
                kept.push_back(corner);
            }
            if (kept.size() < 3)
                continue;
            out_.bytes += 'f';
            for (const Corner& corner : kept) {
                out_.bytes += ' ';
                out_.bytes += std::to_string(corner.vertex);
                if (hasUvs) {
                    out_.bytes += '/';
                    out_.bytes += std::to_string(corner.uv);
                }
            }
            out_.bytes += '\n';
        }
    }

    TextScanner scanner_;
    const std::string& file_;
    CheckedFile out_;
    std::string joined_;
    std::vector<Corner> corners_;
    std::vector<Face> faceList_;
    std::vector<Sharp> sharp_;
    long long vertices_ = 0, uvs_ = 0, coloured_ = 0;
    int faces_ = 0, line_ = 0, statementLine_ = 0;
};

} // namespace

CheckedFile checkedObj(std::string_view bytes, const std::string& place) {
    return ObjChecker(bytes, place).check();
}

} // namespace patina
