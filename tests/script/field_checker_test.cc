#include "operators/fields/field_store.h"
#include "script_context.h"

#include <gmock/gmock.h>

namespace patina {
namespace {

using testing::ElementsAre;

ExposureRequest requestOf(const std::string& map) {
    const Program program = readScript("new copper\ncoat soot 1 " + map + "\n");
    const Expression& e = *coatAt(program, 1).map;
    EXPECT_EQ(e.kind, Expression::Kind::name);
    return e.exposure ? *e.exposure : ExposureRequest();
}

TEST(FieldArguments, ExposureAloneIsSunAndSkyOverTheYear) {
    EXPECT_EQ(requestOf("exposure").fieldName(), "exposure");
    EXPECT_TRUE(requestOf("exposure").light.sun);
    EXPECT_EQ(requestOf("exposure()").fieldName(), "exposure");
}

TEST(FieldArguments, AreReadByName) {
    const ExposureRequest all = requestOf("exposure(sky=overcast, latitude=-52.5, months=(4, 9), hours=(8, 18), "
                                          "clouds=0.2, north=(0, 1, 0), ground=yes, rays=64)");
    EXPECT_EQ(all.light.sky, overcastSky);
    EXPECT_EQ(all.light.latitudeDegrees, -52.5);
    EXPECT_EQ(all.light.firstMonth, 4);
    EXPECT_EQ(all.light.lastMonth, 9);
    EXPECT_EQ(all.light.firstHour, 8.0);
    EXPECT_EQ(all.light.clouds, 0.2);
    EXPECT_TRUE(all.light.sun); // who says where wants the sun as well
    EXPECT_TRUE(all.ground);
    EXPECT_EQ(all.rays, 64);
    EXPECT_FALSE(requestOf("exposure(sky=uniform)").light.sun);
    EXPECT_TRUE(requestOf("exposure(sky=uniform, sun=yes)").light.sun);
    EXPECT_EQ(requestOf("exposure(sky=12)").light.sky, clearSky);
    EXPECT_EQ(requestOf("wetness(latitude=60)").fieldName("wetness"), "wetness_latitude60");
    const Program program = readScript("new copper\ncoat soot 1 1 - accessibility(3mm, soft=0.5mm, global=yes)\n");
    const Expression& accessibility = coatAt(program, 1).map->children.at(1);
    ASSERT_EQ(accessibility.children.size(), 3u);
    EXPECT_DOUBLE_EQ(accessibility.children[0].number, 3000.0);
    EXPECT_DOUBLE_EQ(accessibility.children[1].number, 500.0);
    EXPECT_DOUBLE_EQ(accessibility.children[2].number, 1.0);
}

TEST(FieldArguments, NorthAlongTheModelsUpAxisIsAMistakeWhereTheAxisIsKnown) {
    const std::string script = "new copper\ncoat soot 1 wetness(latitude=50, north=(0, -2, 0))\n";
    EXPECT_NO_THROW(readScript(script));
    CheckContext context = testContext();
    context.up = {0.0, 1.0, 0.0};
    try {
        readScript(script, context);
        FAIL() << "the script was read";
    } catch (const ScriptError& error) {
        EXPECT_THAT(briefly(error.diagnostics()), ElementsAre("2:40: north lies along the model's up axis"));
    }
    context.up = {0.0, 0.0, 1.0};
    EXPECT_NO_THROW(readScript(script, context));
}

TEST(FieldArguments, MistakesAreNamed) {
    EXPECT_THAT(briefly(findingsOf("new copper\n"
                                   "coat soot 1 exposure(latitude=95)\n"
                                   "coat soot 1 exposure(sky=overcats)\n"
                                   "coat soot 1 exposure(sky=17)\n"
                                   "coat soot 1 exposure(months=(4, 13))\n"
                                   "coat soot 1 wetness(altitude=3)\n"
                                   "coat soot 1 exposure(ground=maybe)\n"
                                   "coat soot 1 exposure(rays=8, rays=9)\n"
                                   "coat soot 1 accessibility(3mm, 4mm)\n"
                                   "coat soot 1 accessibility(global=yes)\n")),
                ElementsAre("2:31: the latitude 95 is beyond 90 degrees", "3:26: unknown sky 'overcats'",
                            testing::HasSubstr("4:26: the type of the sky"), "5:29: there is no month 13",
                            "6:21: 'wetness' has no argument 'altitude'", "7:29: ground is yes or no",
                            "8:30: 'rays' is given twice", "9:32: 'accessibility' has one radius",
                            "10:13: 'accessibility' needs a radius"));
}

} // namespace
} // namespace patina
