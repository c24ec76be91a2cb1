#include "export/usd_file.h"

#include "base/atomic_file.h"
#include "base/errors.h"

#include <fmt/format.h>

#include <iterator>

namespace patina {

namespace {

// Lines with the indentation of their block.
class UsdWriter {
  public:
    template <typename... Arguments>
    void line(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
        indent();
        fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
        text_.push_back('\n');
    }
    void blank() { text_.push_back('\n'); }
    void open() {
        line("{{");
        ++depth_;
    }
    void close() {
        --depth_;
        line("}}");
    }
    /// `before` [element, element, …] `after`; elements by index.
    template <typename Element>
    void array(const std::string& before, std::size_t count, Element element) {
        indent();
        const auto out = std::back_inserter(text_);
        fmt::format_to(out, "{} = [", before);
        for (std::size_t i = 0; i < count; ++i) {
            if (i > 0)
                fmt::format_to(out, ", ");
            element(out, i);
        }
        text_.push_back(']');
    }
    void raw(const std::string& text) { text_.append(text.data(), text.data() + text.size()); }
    std::string text() const { return fmt::to_string(text_); }

  private:
    void indent() {
        for (int i = 0; i < depth_; ++i)
            raw("    ");
    }
    fmt::memory_buffer text_;
    int depth_ = 0;
};

using Out = std::back_insert_iterator<fmt::memory_buffer>;

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            out += '\\';
        if (static_cast<unsigned char>(c) < ' ')
            out += ' ';
        else
            out += c;
    }
    return out + '"';
}

// Three of them, since a file's name may hold one.
std::string asset(const std::string& path) {
    const std::string relative =
        path.rfind("./", 0) == 0 || path.rfind("../", 0) == 0 || path.rfind('/', 0) == 0 ? path : "./" + path;
    return relative.find('@') == std::string::npos ? "@" + relative + "@" : "@@@" + relative + "@@@";
}

void writeVectors(UsdWriter& out, const std::string& name, const std::vector<Imath::V3f>& values) {
    out.array(name, values.size(), [&](Out to, std::size_t i) {
        fmt::format_to(to, "({}, {}, {})", values[i].x, values[i].y, values[i].z);
    });
}

// Each crease is a chain of one edge.
void writeSharp(UsdWriter& out, const Mesh& mesh) {
    const auto values = [&](const char* name, std::size_t count, auto value) {
        out.array(name, count, [&](Out to, std::size_t i) { fmt::format_to(to, "{}", value(i)); });
        out.blank();
    };
    if (!mesh.creases.empty()) {
        values("int[] creaseIndices", 2 * mesh.creases.size(),
               [&](std::size_t i) { return i % 2 ? mesh.creases[i / 2].b : mesh.creases[i / 2].a; });
        values("int[] creaseLengths", mesh.creases.size(), [](std::size_t) { return 2; });
        values("float[] creaseSharpnesses", mesh.creases.size(),
               [&](std::size_t i) { return mesh.creases[i].sharpness; });
    }
    if (!mesh.corners.empty()) {
        values("int[] cornerIndices", mesh.corners.size(), [&](std::size_t i) { return mesh.corners[i].vertex; });
        values("float[] cornerSharpnesses", mesh.corners.size(),
               [&](std::size_t i) { return mesh.corners[i].sharpness; });
    }
}

void writeMesh(UsdWriter& out, const UsdScene& scene, const std::string& root) {
    const Mesh& mesh = *scene.mesh;
    const Imath::Box3f box = mesh.bounds();
    out.line("def Mesh \"Surface\" (");
    if (scene.maps.baked)
        out.line("    prepend apiSchemas = [\"MaterialBindingAPI\"]");
    out.line(")");
    out.open();
    out.line("float3[] extent = [({}, {}, {}), ({}, {}, {})]", box.min.x, box.min.y, box.min.z, box.max.x, box.max.y,
             box.max.z);
    const auto plain = [&](const std::string& name, const std::vector<int>& values) {
        out.array(name, values.size(), [&](Out to, std::size_t i) { fmt::format_to(to, "{}", values[i]); });
        out.blank();
    };
    // The rules of surface/limit_surface.h, so that a renderer's limit surface is the one that the maps were baked on.
    out.line("uniform token subdivisionScheme = \"{}\"", scene.scheme);
    if (scene.scheme != "none") {
        out.line("token interpolateBoundary = \"edgeAndCorner\"");
        out.line("token faceVaryingLinearInterpolation = \"boundaries\"");
    }
    if (scene.scheme != "none")
        writeSharp(out, mesh);
    plain("int[] faceVertexCounts", mesh.faceSizes);
    plain("int[] faceVertexIndices", mesh.faceVertices);
    writeVectors(out, "point3f[] points", mesh.positions);
    out.blank();
    if (scene.normals) {
        writeVectors(out, "normal3f[] normals", *scene.normals);
        out.raw(" (\n");
        out.line("    interpolation = \"vertex\"");
        out.line(")");
    }
    if (mesh.hasUvs()) {
        out.array("texCoord2f[] primvars:st", mesh.uvs.size(),
                  [&](Out to, std::size_t i) { fmt::format_to(to, "({}, {})", mesh.uvs[i].x, mesh.uvs[i].y); });
        out.raw(" (\n");
        out.line("    interpolation = \"faceVarying\"");
        out.line(")");
        plain("int[] primvars:st:indices", mesh.faceUvs);
    }
    if (scene.maps.baked) {
        out.line("rel material:binding = <{}/Materials/Patina>", root);
        // Arnold culls what leaves its bounds.
        out.line("float primvars:arnold:disp_padding = {} (", scene.maps.maxDisplacement);
        out.line("    interpolation = \"constant\"");
        out.line(")");
    }
    out.close();
}

// One texture of the UsdPreviewSurface network. Linear values in the file: nothing to decode.
void writeTexture(UsdWriter& out, const UsdScene& scene, const std::string& material, const std::string& map,
                  const std::string& output, const char* decoding = nullptr) {
    out.line("def Shader \"Texture_{}\"", map);
    out.open();
    out.line("uniform token info:id = \"UsdUVTexture\"");
    out.line("asset inputs:file = {}", asset(scene.maps.path(map)));
    out.line("float2 inputs:st.connect = <{}/Reader_st.outputs:result>", material);
    out.line("token inputs:wrapS = \"clamp\"");
    out.line("token inputs:wrapT = \"clamp\"");
    out.line("token inputs:sourceColorSpace = \"raw\"");
    if (decoding) {
        out.line("float4 inputs:scale = (2, 2, 2, 1)");
        out.line("float4 inputs:bias = (-1, -1, -1, 0)");
    }
    out.line("{}", output);
    out.close();
}

void writePreviewSurface(UsdWriter& out, const UsdScene& scene, const std::string& material) {
    out.line("def Shader \"Preview\"");
    out.open();
    out.line("uniform token info:id = \"UsdPreviewSurface\"");
    out.line("color3f inputs:diffuseColor.connect = <{}/Texture_base_color.outputs:rgb>", material);
    out.line("float inputs:metallic.connect = <{}/Texture_metallic.outputs:r>", material);
    out.line("float inputs:roughness.connect = <{}/Texture_roughness.outputs:r>", material);
    out.line("int inputs:useSpecularWorkflow = 0");
    out.line("token outputs:surface");
    out.line("token outputs:displacement");
    out.close();
    out.line("def Shader \"Reader_st\"");
    out.open();
    out.line("uniform token info:id = \"UsdPrimvarReader_float2\"");
    out.line("string inputs:varname = \"st\"");
    out.line("float2 outputs:result");
    out.close();
    writeTexture(out, scene, material, "base_color", "float3 outputs:rgb");
    writeTexture(out, scene, material, "metallic", "float outputs:r");
    writeTexture(out, scene, material, "roughness", "float outputs:r");
    writeTexture(out, scene, material, "displacement", "float outputs:r");
    writeTexture(out, scene, material, "normal", "float3 outputs:rgb", "signed");
}

void writeMaterialXImage(UsdWriter& out, const UsdScene& scene, const std::string& material, const std::string& map,
                         bool colour) {
    out.line("def Shader \"Image_{}\"", map);
    out.open();
    out.line("uniform token info:id = \"ND_image_{}\"", colour ? "color3" : "float");
    if (colour) {
        out.line("asset inputs:file = {} (", asset(scene.maps.path(map)));
        out.line("    colorSpace = \"{}\"", scene.maps.colourSpace == ColourSpace::acescg ? "acescg" : "lin_rec709");
        out.line(")");
    } else {
        out.line("asset inputs:file = {}", asset(scene.maps.path(map)));
    }
    out.line("float2 inputs:texcoord.connect = <{}/Coordinates.outputs:out>", material);
    out.line("string inputs:uaddressmode = \"clamp\"");
    out.line("string inputs:vaddressmode = \"clamp\"");
    out.line("{} outputs:out", colour ? "color3f" : "float");
    out.close();
}

// The network of NAME.mtlx in USD's own words: not every USD can read .mtlx files.
void writeMaterialXNetwork(UsdWriter& out, const UsdScene& scene, const std::string& material) {
    out.line("def Shader \"StandardSurface\"");
    out.open();
    out.line("uniform token info:id = \"ND_standard_surface_surfaceshader\"");
    out.line("float inputs:base = 1");
    out.line("color3f inputs:base_color.connect = <{}/Image_base_color.outputs:out>", material);
    out.line("float inputs:metalness.connect = <{}/Image_metallic.outputs:out>", material);
    out.line("float inputs:specular_roughness.connect = <{}/Image_roughness.outputs:out>", material);
    out.line("token outputs:out");
    out.close();
    out.line("def Shader \"Displacement\"");
    out.open();
    out.line("uniform token info:id = \"ND_displacement_float\"");
    out.line("float inputs:displacement.connect = <{}/Image_displacement.outputs:out>", material);
    out.line("float inputs:scale = 1");
    out.line("token outputs:out");
    out.close();
    out.line("def Shader \"Coordinates\"");
    out.open();
    out.line("uniform token info:id = \"ND_geompropvalue_vector2\"");
    out.line("string inputs:geomprop = \"st\"");
    out.line("float2 outputs:out");
    out.close();
    writeMaterialXImage(out, scene, material, "base_color", true);
    writeMaterialXImage(out, scene, material, "metallic", false);
    writeMaterialXImage(out, scene, material, "roughness", false);
    writeMaterialXImage(out, scene, material, "displacement", false);
}

// Relief comes either from the heights or from the normals, never from both: renderers that displace would show it
// twice.
void writeMaterial(UsdWriter& out, const UsdScene& scene, const std::string& material) {
    out.line("def Material \"Patina\" (");
    out.line("    variants = {{");
    out.line("        string relief = \"displacement\"");
    out.line("    }}");
    out.line("    prepend variantSets = \"relief\"");
    out.line(")");
    out.open();
    out.line("token outputs:surface.connect = <{}/Preview.outputs:surface>", material);
    out.line("token outputs:mtlx:surface.connect = <{}/StandardSurface.outputs:out>", material);
    out.line("token outputs:mtlx:displacement.connect = <{}/Displacement.outputs:out>", material);
    writePreviewSurface(out, scene, material);
    writeMaterialXNetwork(out, scene, material);
    out.line("variantSet \"relief\" = {{");
    out.line("    \"displacement\" {{");
    out.line("        token outputs:displacement.connect = <{}/Preview.outputs:displacement>", material);
    out.line("        over \"Preview\"");
    out.line("        {{");
    out.line("            float inputs:displacement.connect = <{}/Texture_displacement.outputs:r>", material);
    out.line("        }}");
    out.line("    }}");
    out.line("    \"normal\" {{");
    out.line("        over \"Preview\"");
    out.line("        {{");
    out.line("            normal3f inputs:normal.connect = <{}/Texture_normal.outputs:rgb>", material);
    out.line("        }}");
    out.line("    }}");
    out.line("}}");
    out.close();
}

// Level sets drawn as a density would be a shell around the mesh: they are there for those who ask for them.
void writeVolume(UsdWriter& out, const UsdScene& scene, const std::string& root) {
    const Imath::Box3f box = scene.mesh->bounds();
    const double scale = scene.volumeUnitsPerUnit;
    out.line("def Volume \"Volume\"");
    out.open();
    out.line("token visibility = \"invisible\"");
    out.line("float3[] extent = [({}, {}, {}), ({}, {}, {})]", static_cast<float>(box.min.x * scale),
             static_cast<float>(box.min.y * scale), static_cast<float>(box.min.z * scale),
             static_cast<float>(box.max.x * scale), static_cast<float>(box.max.y * scale),
             static_cast<float>(box.max.z * scale));
    if (scale != 1.0) {
        out.line("float3 xformOp:scale = ({0}, {0}, {0})", static_cast<float>(1.0 / scale));
        out.line("uniform token[] xformOpOrder = [\"xformOp:scale\"]");
    }
    for (const UsdField& field : scene.fields)
        out.line("rel field:{0} = <{1}/Volume/{0}>", identifierOf(field.grid), root);
    for (const UsdField& field : scene.fields) {
        out.line("def OpenVDBAsset \"{}\"", identifierOf(field.grid));
        out.open();
        out.line("asset filePath = {}", asset(scene.volumeFile));
        out.line("token fieldName = {}", quoted(field.grid));
        out.line("token fieldDataType = \"{}\"", field.integer ? "int" : "float");
        out.line("token fieldClass = \"{}\"", field.levelSet ? "levelSet" : "unknown");
        out.close();
    }
    out.close();
}

} // namespace

std::string usdText(const UsdScene& scene) {
    if (!scene.mesh || scene.mesh->positions.empty())
        throw RunError(scene.name, "there is no mesh to write");
    if (scene.normals && scene.normals->size() != scene.mesh->positions.size())
        throw RunError(scene.name,
                       fmt::format("{} normals for {} vertices", scene.normals->size(), scene.mesh->positions.size()));
    const std::string name = identifierOf(scene.name);
    const std::string root = "/" + name;
    UsdWriter out;
    out.line("#usda 1.0");
    out.line("(");
    out.line("    defaultPrim = \"{}\"", name);
    out.line("    doc = {}", quoted(scene.documentation));
    out.line("    metersPerUnit = {}", scene.metresPerUnit);
    out.line("    upAxis = \"{}\"", scene.zUp ? "Z" : "Y");
    out.line(")");
    out.blank();
    out.line("def Xform \"{}\" (", name);
    out.line("    kind = \"component\"");
    out.line(")");
    out.open();
    writeMesh(out, scene, root);
    if (scene.maps.baked) {
        out.line("def Scope \"Materials\"");
        out.open();
        writeMaterial(out, scene, root + "/Materials/Patina");
        out.close();
    }
    if (!scene.volumeFile.empty())
        writeVolume(out, scene, root);
    out.close();
    return out.text();
}

void writeUsd(const UsdScene& scene, const std::filesystem::path& path) {
    writeTextFile(path, usdText(scene));
}

} // namespace patina
