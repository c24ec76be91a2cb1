#pragma once
// The names a script has declared so far.

#include "script/program.h"

#include <cstddef>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace patina {

/// What a name stands for.
struct Declaration {
    enum class Kind { parameter, map, curve };
    Kind kind = Kind::parameter;
    std::size_t offset = 0;
    Expression value; ///< parameter: a number; map: resolved
    int nodes = 1;    ///< of the value
    std::shared_ptr<const Curve> curve;
    bool broken = false; ///< its value has an error: uses are not reported again
    bool used = false;
};

/// Declarations of the script and, inside `repeat`, of the blocks around the place that is being checked.
class Scope {
  public:
    Scope() : levels_(1) {}

    Declaration* find(const std::string& name) {
        for (auto level = levels_.rbegin(); level != levels_.rend(); ++level)
            if (const auto found = level->find(name); found != level->end())
                return &found->second;
        return nullptr;
    }
    void declare(const std::string& name, Declaration declaration) { levels_.back()[name] = std::move(declaration); }

    void push() { levels_.emplace_back(); }
    std::map<std::string, Declaration> pop() {
        auto last = std::move(levels_.back());
        levels_.pop_back();
        return last;
    }
    const std::map<std::string, Declaration>& innermost() const { return levels_.back(); }

    std::vector<std::string> names() const {
        std::vector<std::string> all;
        for (const auto& level : levels_)
            for (const auto& [name, declaration] : level)
                all.push_back(name);
        return all;
    }

    std::vector<int> steps;            ///< of the `repeat`s around the place, innermost last
    std::set<std::string> brokenNames; ///< would have been declared by statements with errors

  private:
    std::vector<std::map<std::string, Declaration>> levels_;
};

} // namespace patina
