#include "export/materialx_file.h"

#include <gmock/gmock.h>

namespace patina {
namespace {

using testing::HasSubstr;
using testing::Not;

MaterialMaps baked(ColourSpace space) {
    MaterialMaps maps;
    maps.baked = true;
    maps.colourSpace = space;
    return maps;
}

TEST(MaterialXFile, ReadsTheMapsWithTheirColourSpaces) {
    const std::string text = materialXText("marine", baked(ColourSpace::rec709));
    EXPECT_THAT(text, HasSubstr("value=\"./base_color.exr\" colorspace=\"lin_rec709\""));
    // Data has none: a colour transform would change heights.
    for (const char* map : {"metallic", "roughness", "displacement", "normal"})
        EXPECT_THAT(text, HasSubstr(std::string("value=\"./") + map + ".exr\" />")) << map;
    EXPECT_THAT(materialXText("marine", baked(ColourSpace::acescg)), HasSubstr("colorspace=\"acescg\""));
}

TEST(MaterialXFile, ReliefIsDisplacementOrNormalsAndNeverBoth) {
    const std::string text = materialXText("marine", baked(ColourSpace::rec709));
    const std::size_t second = text.find("<standard_surface name=\"marine_normal_shader\"");
    ASSERT_NE(second, std::string::npos);
    EXPECT_THAT(text.substr(0, second), HasSubstr("nodename=\"marine_displacement\""));
    EXPECT_THAT(text.substr(0, second), Not(HasSubstr("output=\"out_normal\"")));
    EXPECT_THAT(text.substr(second), HasSubstr("output=\"out_normal\""));
    EXPECT_THAT(text.substr(second), Not(HasSubstr("displacementshader")));
}

TEST(MaterialXFile, NamesAreThoseThatMaterialXTakes) {
    const std::string text = materialXText("30 years & more", baked(ColourSpace::rec709));
    EXPECT_THAT(text, HasSubstr("<surfacematerial name=\"_30_years___more\" type=\"material\">"));
}

} // namespace
} // namespace patina
