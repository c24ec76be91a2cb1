// Kinetics in scripts: iso9224() against the standard's own table, expansion(), and what is said of mistakes.

#include "script_context.h"

#include "base/errors.h"

#include <gmock/gmock.h>

namespace patina {
namespace {

CheckContext context(const std::string& position = "") {
    CheckContext out = testContext();
    out.kinetics = readKinetics(std::filesystem::path(PATINA_SOURCE_DIR) / "data");
    if (!position.empty())
        out.settings["place"] = position;
    return out;
}

double thickness(const std::string& expression, const CheckContext& with = context()) {
    return coatAt(readScript("new copper\ncoat brochantite " + expression, with), 1).thicknessUm;
}

TEST(Kinetics, FollowTheTableOfTheStandard) {
    // ISO 9224:2012, table 3, columns B1: D over the first year's loss, to three digits behind the point.
    const struct {
        const char* metal;
        double years, factor;
    } table[] = {{"copper", 1, 1.0}, {"copper", 2, 1.588}, {"copper", 10, 4.645}, {"copper", 20, 7.375},
                 {"zinc", 5, 3.701}, {"zinc", 20, 11.422}, {"steel", 3, 1.776},   {"steel", 20, 4.791}};
    for (const auto& row : table) {
        const double first = thickness(fmt::format("iso9224({}, C3, 1)", row.metal));
        EXPECT_NEAR(thickness(fmt::format("iso9224({}, C3, {})", row.metal, row.years)) / first, row.factor, 0.0006)
            << row.metal << ", " << row.years;
    }
    // Beyond 20 years along the tangent (docs/weather.md); the table goes on with the power instead.
    const double at20 = thickness("iso9224(copper, C3, 20)"), at30 = thickness("iso9224(copper, C3, 30)");
    EXPECT_NEAR(at30 - at20, 10.0 * 0.667 * at20 / 20.0, 1e-9);
    EXPECT_EQ(thickness("iso9224(copper, C3, 0)"), 0.0);
}

TEST(Kinetics, ACategorysRangeIsTwoRunsOfOneScript) {
    const std::string script = "param place = 0.5\nnew copper\ncoat brochantite iso9224(copper, C4, 1, place)\n";
    const auto ran = [&](const char* place) { return coatAt(readScript(script, context(place)), 1).thicknessUm; };
    EXPECT_DOUBLE_EQ(ran("0"), 1.3); // ISO 9223:2012, table 2
    EXPECT_DOUBLE_EQ(ran("1"), 2.8);
    EXPECT_NEAR(ran("0.5"), std::sqrt(1.3 * 2.8), 1e-12);
    EXPECT_DOUBLE_EQ(ran("0.5"), thickness("iso9224(copper, C4, 1)"));
}

TEST(Kinetics, MineralsSwell) {
    EXPECT_DOUBLE_EQ(thickness("iso9224(copper, C4, 1, 0) * expansion(brochantite) / 2"), 1.3 * 4.02 / 2.0);
    EXPECT_NEAR(thickness("1um * expansion(marine_patina_4)"), 4.36, 0.3); // docs/weather.md, a mixture
}

TEST(Kinetics, WhatIsNotKnownIsSaidWithWhatIs) {
    const auto said = [&](const std::string& expression) {
        const auto findings = findingsOf("new copper\ncoat brochantite " + expression, context());
        EXPECT_EQ(findings.size(), 1u) << expression;
        return findings.empty() ? "" : findings[0].message + " | " + findings[0].remedy;
    };
    using testing::HasSubstr;
    EXPECT_THAT(said("iso9224(coper, C4, 1)"), testing::AllOf(HasSubstr("'coper' is not known"), HasSubstr("'copper'")));
    EXPECT_THAT(said("iso9224(copper, D9, 1)"), testing::AllOf(HasSubstr("'D9' is not known"), HasSubstr("C1")));
    EXPECT_THAT(said("iso9224(copper, C4, 1, 1.5)"), HasSubstr("between 0 and 1"));
    EXPECT_THAT(said("iso9224(copper, C4, 2mm)"), HasSubstr("without a unit"));
    EXPECT_THAT(said("iso9224(copper, C4, noise(1mm))"), HasSubstr("varies over the surface"));
    EXPECT_THAT(said("iso9224(copper, C4)"), HasSubstr("too few"));
    EXPECT_THAT(said("iso9224(3, C4, 1)"), HasSubstr("is a name"));
    EXPECT_THAT(said("2um * expansion(soot)"), HasSubstr("'soot' is not known"));
}

} // namespace
} // namespace patina
