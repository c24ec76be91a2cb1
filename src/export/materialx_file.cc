#include "export/materialx_file.h"

#include "base/atomic_file.h"

#include <fmt/format.h>

#include <iterator>

namespace patina {

namespace {

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text)
        switch (c) {
        case '&':
            out += "&amp;";
            break;
        case '<':
            out += "&lt;";
            break;
        case '>':
            out += "&gt;";
            break;
        case '"':
            out += "&quot;";
            break;
        default:
            out += c;
        }
    return out;
}

using Out = std::back_insert_iterator<std::string>;

void writeImage(Out out, const MaterialMaps& maps, const std::string& map, const char* type) {
    const bool colour = std::string(type) == "color3";
    const char* space = maps.colourSpace == ColourSpace::acescg ? "acescg" : "lin_rec709";
    fmt::format_to(out, "    <image name=\"{}\" type=\"{}\">\n", map, type);
    fmt::format_to(out, "      <input name=\"file\" type=\"filename\" value=\"{}\"{} />\n", escaped(maps.path(map)),
                   colour ? fmt::format(" colorspace=\"{}\"", space) : "");
    fmt::format_to(out, "      <input name=\"uaddressmode\" type=\"string\" value=\"clamp\" />\n"
                        "      <input name=\"vaddressmode\" type=\"string\" value=\"clamp\" />\n"
                        "    </image>\n");
}

// One of the two materials on the same textures.
void writeMaterial(Out out, const std::string& name, bool displaced) {
    const char* graph = "patina_maps";
    fmt::format_to(out, "  <standard_surface name=\"{}_shader\" type=\"surfaceshader\">\n", name);
    fmt::format_to(out, "    <input name=\"base\" type=\"float\" value=\"1\" />\n");
    const auto connect = [&](const char* input, const char* type, const char* output) {
        fmt::format_to(out, "    <input name=\"{}\" type=\"{}\" nodegraph=\"{}\" output=\"{}\" />\n", input, type,
                       graph, output);
    };
    connect("base_color", "color3", "out_base_color");
    connect("metalness", "float", "out_metallic");
    connect("specular_roughness", "float", "out_roughness");
    if (!displaced)
        connect("normal", "vector3", "out_normal");
    fmt::format_to(out, "  </standard_surface>\n");
    if (displaced) {
        fmt::format_to(out, "  <displacement name=\"{}_displacement\" type=\"displacementshader\">\n", name);
        connect("displacement", "float", "out_displacement");
        fmt::format_to(out, "    <input name=\"scale\" type=\"float\" value=\"1\" />\n  </displacement>\n");
    }
    fmt::format_to(out, "  <surfacematerial name=\"{}\" type=\"material\">\n", name);
    fmt::format_to(out, "    <input name=\"surfaceshader\" type=\"surfaceshader\" nodename=\"{}_shader\" />\n", name);
    if (displaced)
        fmt::format_to(out,
                       "    <input name=\"displacementshader\" type=\"displacementshader\" "
                       "nodename=\"{}_displacement\" />\n",
                       name);
    fmt::format_to(out, "  </surfacematerial>\n");
}

} // namespace

std::string materialXText(const std::string& name, const MaterialMaps& maps) {
    const std::string material = identifierOf(name);
    std::string text = "<?xml version=\"1.0\"?>\n<materialx version=\"1.38\" colorspace=\"lin_rec709\">\n"
                       "  <nodegraph name=\"patina_maps\">\n";
    const Out out(text);
    writeImage(out, maps, "base_color", "color3");
    writeImage(out, maps, "metallic", "float");
    writeImage(out, maps, "roughness", "float");
    writeImage(out, maps, "displacement", "float");
    writeImage(out, maps, "normal", "vector3");
    fmt::format_to(out, "    <normalmap name=\"bent_normal\" type=\"vector3\">\n"
                        "      <input name=\"in\" type=\"vector3\" nodename=\"normal\" />\n"
                        "    </normalmap>\n");
    const auto output = [&](const char* map, const char* type, const char* node) {
        fmt::format_to(out, "    <output name=\"out_{}\" type=\"{}\" nodename=\"{}\" />\n", map, type, node);
    };
    output("base_color", "color3", "base_color");
    output("metallic", "float", "metallic");
    output("roughness", "float", "roughness");
    output("displacement", "float", "displacement");
    output("normal", "vector3", "bent_normal");
    text += "  </nodegraph>\n";
    writeMaterial(out, material, true);
    writeMaterial(out, material + "_normal", false);
    text += "</materialx>\n";
    return text;
}

void writeMaterialX(const std::string& name, const MaterialMaps& maps, const std::filesystem::path& path) {
    writeTextFile(path, materialXText(name, maps));
}

} // namespace patina
