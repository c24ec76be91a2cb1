#pragma once
// A script that has been read and checked: a flat list of operations in which nothing is left to look up.
// Parameters, `let`s and constant expressions are evaluated, `repeat` is unrolled, labels are given.

#include "base/errors.h"

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace patina {

struct ExposureRequest;
struct GrowthCall;

/// `curve NAME = (0, 0) (5, 1.2) (30, 2);`: straight lines between points sorted by their first number, held constant
/// before the first and after the last. With `smooth` behind the points, the monotone cubic through them: it has a
/// continuous slope and never leaves the range of the two points it is between.
struct Curve {
    std::string name;
    std::vector<std::pair<double, double>> points; ///< (years, value); values in µm where `isLength`
    bool isLength = false;
    bool isSmooth = false;

    double value(double x) const;
};

/// A map over the surface as a tree. What a checked program can hold, by kind:
/// - number: `number`, µm where `isLength`
/// - string: `text` is a file, relative names joined to the script's folder; only the first argument of `texture`
/// - name: `text` is a field (`exposure`, `wetness`, `slope`, `elevation`), or an argument of `texture` or `vertices`:
/// a
///   channel or an attribute
/// - call: `text` is the function: `texture` (of a file), `vertices`, `noise`, `turbulence`, `facing`, `min`, `max`,
///   `clamp`, `mix`, `pow`, `smoothstep`, its `children` their arguments, whose number is checked; of `accessibility`
///   they are always three: radius, softness (0: none), 1 where it is global
/// - unary: `text` is `-`, one child; binary: `+`, `-`, `*` or `/`, two
/// - growth: `growth`, of texture(BD.linear_1.20)
/// - curve: `text` is its name, `curve`, and one child: its argument
///
/// Every constant part has been folded into one number.
struct Expression {
    enum class Kind { number, string, name, call, unary, binary, growth, curve };

    Kind kind = Kind::number;
    SourcePlace place;
    double number = 0.0;
    bool isLength = false; ///< the value is a length, in µm
    std::string text;
    std::vector<Expression> children;
    std::shared_ptr<const GrowthCall> growth;
    std::shared_ptr<const Curve> curve;
    std::shared_ptr<const ExposureRequest> exposure; ///< of `exposure` and `wetness` with arguments
};

/// A growth model at one moment of its history: `BD.linear_1.20`, or BD(rate=linear, step=1, total=20, …).
struct GrowthCall {
    SourcePlace place;
    std::string model; ///< "ST", "RD", "RDR", "BD", "DPD" or "DPD_BS"
    std::string rate;  ///< "linear", "parabolic", "cubic" or "logarithmic"
    int step = 1;      ///< 0 … total
    int total = 1;
    bool ofFull = false; ///< `of full`: normalised at the last step, not at its own
    int since = 0;       ///< what has grown since this step, below `step`; above 0, ofFull is set

    /// The random key: the statement's label; the second growth of one statement has "/2" behind it, and so on.
    std::string label;

    // What is not set was not given in the script.
    std::optional<double> cellUm;              ///< size of a particle, > 0
    std::optional<Expression> arrival;         ///< density of arriving particles (RD, RDR, BD)
    std::optional<std::array<double, 3>> from; ///< where particles come from, unit vector (RD, RDR, BD)
    std::optional<double> reachUm;             ///< how far a particle relaxes (RDR), >= 0
    std::optional<Expression> blocked;         ///< fraction of blocked cells (DPD, DPD_BS)
    std::optional<int> patchCells;             ///< side of a seed patch in cells (DPD), >= 1
    std::optional<double> seeding;             ///< chance of new seed patches (DPD), 0…1
    std::optional<int> points;                 ///< number of sample points (ST), >= 1
};

/// `new copper;`
struct NewMetal {
    std::string metal;
};

/// `open "statue.vdb";`
struct OpenFile {
    std::string file; ///< as written, or joined to the script's folder where it is relative
};

/// `coat M t MAP as NAME;` (the name is the statement's label)
struct Coat {
    std::string material;
    double thicknessUm = 0.0;
    std::optional<Expression> map;
};

/// `erode t MAP by hardness and metal;`
struct Erode {
    double thicknessUm = 0.0;
    std::optional<Expression> map;
    bool byHardness = false;
    bool andMetal = false;
};

/// `grow M t MAP everywhere;`
struct Grow {
    std::string material;
    double thicknessUm = 0.0;
    std::optional<Expression> map;
    bool everywhere = false; ///< also where M is not
};

/// `convert A to B fraction MAP;`
struct Convert {
    std::string from;
    std::string to;
    double fraction = 1.0; ///< 0…1
    std::optional<Expression> map;
};

/// `fill M height MAP above smooth(r);`
struct Fill {
    std::string material;
    double heightUm = 0.0;
    std::optional<Expression> map;
    std::optional<double> aboveSmoothRadiusUm;
};

/// `polish h MAP;` or `polish area a MAP window r of M;`: exactly one of heightUm and area is set.
struct Polish {
    std::optional<double> heightUm;
    std::optional<double> area; ///< 0…1
    std::optional<Expression> map;
    std::optional<double> windowUm;
    std::string ofMaterial; ///< empty where any material counts
};

/// `offset M r tangent-sphere t global;`
struct Offset {
    std::string material;
    double radiusUm = 0.0; ///< a length of the model; the exaggeration does not scale it
    std::optional<double> tangentSphereThicknessUm;
    bool global = false;
};

/// `render maps;`
struct Render {
    std::string what;
};

/// One operation, with where it stands and what it was called.
struct Statement {
    using Action = std::variant<NewMetal, OpenFile, Coat, Erode, Grow, Convert, Fill, Polish, Offset, Render>;

    SourcePlace place;
    std::string text; ///< as written, without its end and comments, on one line
    std::string word; ///< "coat", "erode", …
    /// The name behind `as`. Otherwise for coats the material, with "#2" where it is coated for the second time; for
    /// others their word (and material), "erode#2", "fill dirt".
    std::string label;
    int repeatStep = 0; ///< 1 … N inside a `repeat`, of the innermost one; 0 outside
    Action action;
};

/// A parameter with the value it has in this run.
struct Parameter {
    std::string name;
    double value = 0.0; ///< µm where isLength
    bool isLength = false;
    bool wasSet = false; ///< by --set
};

/// A whole script, ready to run.
struct Program {
    std::string name; ///< the file's stem
    std::string file;
    std::string sourceText;
    std::vector<Statement> statements; ///< the first is NewMetal or OpenFile
    std::vector<Parameter> parameters;
    std::vector<Curve> curves;         ///< in the order of their declarations
    std::optional<std::uint64_t> seed; ///< of `seed N;`
    std::vector<Diagnostic> warnings;
};

} // namespace patina
