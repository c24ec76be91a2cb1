#pragma once
// From a script's text to a program: every error of the script in one go, nothing left to go wrong by a name.

#include "script/kinetics.h"
#include "script/program.h"

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace patina {

struct SyntaxTree;

/// What the program around a script knows: names it may use, and what this build can do.
struct CheckContext {
    struct Material {
        std::string name;
        bool isMetal = false;
    };

    std::vector<Material> materials;
    /// Names of the model's per-vertex attributes; not set where no model is known (then any name passes).
    std::optional<std::vector<std::string>> vertexAttributes;
    /// Relative file names start here. Empty: the folder of the script.
    std::filesystem::path baseFolder;
    /// Values of `--set NAME=VALUE`, VALUE as typed ("0.3", "2mm").
    std::map<std::string, std::string> settings;
    Kinetics kinetics;      ///< for iso9224() and expansion()
    bool checkFiles = true; ///< that textures and volumes exist, and textures are images that have the channel

    // What this build implements. A word of the language that is missing here is an error of the script.
    std::set<std::string> operators = allOperators(); ///< "new", "open", "coat", …
    std::set<std::string> functions = allFunctions(); ///< "texture", "noise", "accessibility", "exposure", …
    std::set<std::string> models = allGrowthModels(); ///< "ST", "RD", …
    std::set<std::string> growthArguments = allGrowthArguments(); ///< "cell", "arrival", …
    /// The model's up axis, where it is known: `north` must not lie along it.
    std::optional<std::array<double, 3>> up;
    std::set<std::string> clauses = allClauses(); ///< by, and, above, window, of, tangent-sphere, global, everywhere
    std::set<std::string> renderTargets = {"maps"};

    static std::set<std::string> allOperators();
    static std::set<std::string> allFunctions();
    static std::set<std::string> allGrowthModels();
    static std::set<std::string> allGrowthArguments();
    static std::set<std::string> allClauses();
};

/// Checks a parsed script and resolves it.
/// \throws ScriptError with every finding of parser and checker, in the order of the text (exit 3).
Program check(const SyntaxTree& tree, const CheckContext& context);

/// parse() and check(). `file` names the script in messages.
Program readProgram(const std::string& text, const std::string& file, const CheckContext& context);

/// Reads a script from a file. \throws RunError when it cannot be read, ScriptError as check().
Program readProgramFile(const std::filesystem::path& path, const CheckContext& context);

} // namespace patina
