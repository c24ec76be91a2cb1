#pragma once
// What the tests of this folder share: a context with a few materials, and short ways to read and to fail.

#include "script/checker.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace patina {

inline CheckContext testContext() {
    CheckContext context;
    for (const char* name : {"copper", "bronze"})
        context.materials.push_back({name, true});
    for (const char* name :
         {"tarnish_1", "cuprite_2", "marine_patina_3", "marine_patina_4", "rural_patina_3", "rural_patina_4",
          "cuprite_urban_2", "patina_urban_3", "patina_urban_4", "dirt", "soot", "wax", "posnjakite", "brochantite"})
        context.materials.push_back({name, false});
    return context;
}

inline Program readScript(const std::string& text, const CheckContext& context = testContext()) {
    return readProgram(text, "test.patina", context);
}

/// The findings of a script that must fail; empty (and a test failure) where it does not.
inline std::vector<Diagnostic> findingsOf(const std::string& text, const CheckContext& context = testContext()) {
    try {
        readScript(text, context);
    } catch (const ScriptError& error) {
        return error.diagnostics();
    }
    ADD_FAILURE() << "no error in: " << text;
    return {};
}

/// "2:6: message" of every finding.
inline std::vector<std::string> briefly(const std::vector<Diagnostic>& findings) {
    std::vector<std::string> out;
    for (const Diagnostic& one : findings)
        out.push_back(fmt::format("{}:{}: {}", one.place.line, one.place.column, one.message));
    return out;
}

inline const Coat& coatAt(const Program& program, std::size_t index) {
    return std::get<Coat>(program.statements.at(index).action);
}

} // namespace patina
