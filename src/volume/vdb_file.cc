#include "volume/vdb_file.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "base/hash.h"
#include "volume/nest_grids.h"
#include "volume/region.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string_view>

namespace patina {

namespace {

constexpr int formatVersion = 1;

std::string join(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words)
        text += (text.empty() ? "" : ",") + word;
    return text;
}

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> words;
    std::istringstream in(text);
    for (std::string word; std::getline(in, word, ',');)
        words.push_back(word);
    return words;
}

// A view that shares the tree, so that naming and metadata of a file touch nothing of the volume.
template <typename Grid>
openvdb::GridBase::Ptr named(const Grid& grid, const std::string& name, openvdb::GridClass gridClass,
                             bool half = false) {
    auto view = std::make_shared<Grid>(const_cast<Grid&>(grid), openvdb::ShallowCopy());
    view->setName(name);
    view->setGridClass(gridClass);
    view->setCreator("vdb-patina");
    view->setSaveFloatAsHalf(half);
    return view;
}

template <typename Value>
Value required(const openvdb::MetaMap& meta, const std::string& key, const std::string& file) {
    const auto found = meta.getMetadata<openvdb::TypedMetadata<Value>>(key);
    if (!found)
        throw RunError(file, fmt::format("has no metadata '{}'", key), "was this file written by vdb-patina run?");
    return found->value();
}

std::string optionalText(const openvdb::MetaMap& meta, const std::string& key) {
    const auto found = meta.getMetadata<openvdb::StringMetadata>(key);
    return found ? found->value() : std::string();
}

template <typename Grid>
typename Grid::Ptr requiredGrid(openvdb::GridPtrVec& grids, const std::string& name, const std::string& file) {
    for (auto& grid : grids)
        if (grid->getName() == name) {
            if (auto typed = openvdb::gridPtrCast<Grid>(grid))
                return typed;
            throw RunError(file, fmt::format("grid '{}' holds {} where {} was expected", name, grid->valueType(),
                                             Grid().valueType()));
        }
    throw RunError(file, fmt::format("has no grid '{}'", name), "was this file written by vdb-patina run?");
}

// OpenVDB trusts the counts in a file, and a damaged one can make it loop or take all memory. So a seal stands behind
// the file's last byte, where other readers do not look: eight letters and a hash of all that stands before.
constexpr std::string_view sealWord = "PATINA01";
constexpr std::size_t sealBytes = 16;

std::uint64_t hashOfFile(std::istream& in, std::uint64_t bytes) {
    ContentHash hash;
    std::vector<char> buffer(1 << 20);
    while (bytes > 0) {
        const auto part = static_cast<std::streamsize>(std::min<std::uint64_t>(bytes, buffer.size()));
        in.read(buffer.data(), part);
        if (in.gcount() != part)
            break;
        hash.add(buffer.data(), static_cast<std::size_t>(part));
        bytes -= static_cast<std::uint64_t>(part);
    }
    return hash.digest();
}

void seal(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    const std::uint64_t digest = hashOfFile(in, std::filesystem::file_size(file));
    std::ofstream out(file, std::ios::binary | std::ios::app);
    out.write(sealWord.data(), static_cast<std::streamsize>(sealWord.size()));
    out.write(reinterpret_cast<const char*>(&digest), sizeof digest);
    out.flush();
    if (!in || !out)
        throw RunError(file.string(), "cannot be written", "is the disk full?");
}

void checkSeal(const std::filesystem::path& file) {
    const RunError damaged(file.string(), "is damaged, or was not written by vdb-patina",
                           "only whole volumes, as `run` wrote them, can be opened");
    const std::uint64_t size = std::filesystem::file_size(file);
    if (size < sealBytes)
        throw damaged;
    std::ifstream in(file, std::ios::binary);
    const std::uint64_t digest = hashOfFile(in, size - sealBytes);
    std::string word(sealWord.size(), ' ');
    std::uint64_t written = 0;
    in.read(word.data(), static_cast<std::streamsize>(word.size()));
    in.read(reinterpret_cast<char*>(&written), sizeof written);
    if (!in || word != sealWord || written != digest)
        throw damaged;
}

} // namespace

void initializeVolumes() {
    openvdb::initialize();
}

void writeVolume(const LayerVolume& volume, const std::filesystem::path& path, const VolumeFileOptions& options) {
    const NestGrids& grids = volume.grids();
    openvdb::GridPtrVec out;
    out.push_back(named(*grids.base, "base", openvdb::GRID_LEVEL_SET));
    if (grids.metal)
        out.push_back(named(*grids.metal, "metal", openvdb::GRID_LEVEL_SET));
    out.push_back(named(grids.surface(), "surface", openvdb::GRID_LEVEL_SET));
    for (int k = 1; k <= volume.layerCount(); ++k)
        out.push_back(named(*grids.interfaces[k - 1], volume.interfaceGridName(k), openvdb::GRID_LEVEL_SET));
    out.push_back(named(*grids.material, "material", openvdb::GRID_UNKNOWN));
    for (const auto& [name, field] : grids.fields)
        out.push_back(named(*field, name, openvdb::GRID_UNKNOWN, options.halfFields));

    openvdb::MetaMap meta;
    const LayerVolume::Provenance& from = volume.provenance;
    meta.insertMeta("creator", openvdb::StringMetadata("vdb-patina " + from.program));
    meta.insertMeta("patina_format", openvdb::Int32Metadata(formatVersion));
    meta.insertMeta("patina_version", openvdb::StringMetadata(from.program));
    meta.insertMeta("patina_script", openvdb::StringMetadata(from.script));
    meta.insertMeta("patina_script_name", openvdb::StringMetadata(from.scriptName));
    meta.insertMeta("patina_model", openvdb::StringMetadata(from.model));
    meta.insertMeta("patina_model_hash", openvdb::StringMetadata(from.modelHash));
    meta.insertMeta("patina_seed", openvdb::StringMetadata(std::to_string(from.seed)));
    if (!options.up.empty())
        meta.insertMeta("patina_up", openvdb::StringMetadata(options.up));
    if (!from.region.empty())
        meta.insertMeta("patina_region", openvdb::StringMetadata(from.region));
    meta.insertMeta("patina_voxel_size", openvdb::DoubleMetadata(volume.scale().voxelSize));
    meta.insertMeta("patina_metres_per_unit", openvdb::DoubleMetadata(volume.scale().metresPerUnit));
    meta.insertMeta("patina_exaggeration", openvdb::DoubleMetadata(volume.scale().exaggeration));
    meta.insertMeta("patina_palette", openvdb::StringMetadata(join(volume.palette())));
    meta.insertMeta("patina_layers", openvdb::StringMetadata(join(volume.layers())));
    meta.insertMeta("patina_interior_band", openvdb::DoubleMetadata(grids.interiorBand));
    meta.insertMeta("patina_exterior_band", openvdb::DoubleMetadata(grids.exteriorBand));
    // On every grid too: Houdini and Blender show a grid's metadata, not a file's.
    for (auto& grid : out)
        for (auto item = meta.beginMeta(); item != meta.endMeta(); ++item)
            if (item->first != "creator" && item->first != "patina_script")
                grid->insertMeta(item->first, *item->second);

    AtomicFile file(path);
    try {
        openvdb::io::File vdb(file.temporary().string());
        vdb.setInstancingEnabled(false); // `surface` shares its tree with the last interface; readers want both whole
        vdb.write(out, meta);
        vdb.close();
    } catch (const openvdb::Exception& failure) {
        throw RunError(path.string(), fmt::format("cannot write the volume: {}", failure.what()), "is the disk full?");
    }
    seal(file.temporary());
    file.commit();
}

void checkVolumeFile(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored))
        throw RunError(path.string(), "there is no such file");
    checkSeal(path);
}

std::string upAxisOf(const std::filesystem::path& path) {
    checkVolumeFile(path);
    try {
        openvdb::io::File vdb(path.string());
        vdb.open(/*delayLoad=*/false);
        return optionalText(*vdb.getMetadata(), "patina_up");
    } catch (const openvdb::Exception& failure) {
        throw RunError(path.string(), fmt::format("cannot be read as a volume: {}", failure.what()),
                       "is it a whole .vdb file?");
    }
}

LayerVolume readVolume(const std::filesystem::path& path) {
    const std::string file = path.string();
    checkVolumeFile(path);
    openvdb::GridPtrVecPtr read;
    openvdb::MetaMap::Ptr meta;
    try {
        openvdb::io::File vdb(file);
        vdb.open(/*delayLoad=*/false);
        read = vdb.getGrids();
        meta = vdb.getMetadata();
        vdb.close();
    } catch (const std::exception& failure) {
        throw RunError(file, fmt::format("cannot be read as a volume: {}", failure.what()), "is it a whole .vdb file?");
    }
    const int format = required<openvdb::Int32>(*meta, "patina_format", file);
    if (format != formatVersion)
        throw RunError(file, fmt::format("is of format {}, this program reads format {}", format, formatVersion));

    VolumeScale scale;
    scale.voxelSize = required<double>(*meta, "patina_voxel_size", file);
    scale.metresPerUnit = required<double>(*meta, "patina_metres_per_unit", file);
    scale.exaggeration = required<double>(*meta, "patina_exaggeration", file);
    const auto palette = split(required<std::string>(*meta, "patina_palette", file));
    const auto layers = split(required<std::string>(*meta, "patina_layers", file));
    if (palette.size() < 2 || !(scale.voxelSize > 0.0) || !(scale.metresPerUnit > 0.0) || !(scale.exaggeration > 0.0))
        throw RunError(file, "its patina_… metadata are damaged");

    auto grids = std::make_unique<NestGrids>();
    grids->interiorBand = required<double>(*meta, "patina_interior_band", file);
    grids->exteriorBand = required<double>(*meta, "patina_exterior_band", file);
    grids->base = requiredGrid<openvdb::FloatGrid>(*read, "base", file);
    for (auto& grid : *read)
        if (grid->getName() == "metal") {
            grids->metal = requiredGrid<openvdb::FloatGrid>(*read, "metal", file);
            if (!grids->metal->tree().hasSameTopology(grids->base->tree()))
                throw RunError(file, "grid 'metal' has another topology than 'base'");
        }
    auto material = requiredGrid<openvdb::Int32Grid>(*read, "material", file);
    NestGrids* raw = grids.get();
    LayerVolume volume(scale, palette[1], std::move(grids));
    for (std::size_t id = 2; id < palette.size(); ++id)
        volume.materialId(palette[id]);
    for (std::size_t k = 0; k < layers.size(); ++k) {
        const std::string name = fmt::format("interface_{:02d}_{}", k + 1, layers[k]);
        auto interface = requiredGrid<openvdb::FloatGrid>(*read, name, file);
        if (!interface->tree().hasSameTopology(raw->base->tree()))
            throw RunError(file, fmt::format("grid '{}' has another topology than 'base'", name));
        volume.pushLayer(layers[k]);
        raw->interfaces.back() = interface;
    }
    if (!material->tree().hasSameTopology(raw->base->tree()))
        throw RunError(file, "grid 'material' has another topology than 'base'");
    raw->material = material;
    for (auto& grid : *read) {
        const std::string name = grid->getName();
        auto field = openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
        if (field && grid->getGridClass() == openvdb::GRID_UNKNOWN)
            raw->fields[name] = field;
    }

    LayerVolume::Provenance& from = volume.provenance;
    from.script = optionalText(*meta, "patina_script");
    from.scriptName = optionalText(*meta, "patina_script_name");
    from.model = optionalText(*meta, "patina_model");
    from.modelHash = optionalText(*meta, "patina_model_hash");
    from.program = optionalText(*meta, "patina_version");
    from.region = optionalText(*meta, "patina_region");
    // A volume keeps the space that it was made in; the transform of a region's grids leads into the model.
    raw->space = IndexSpace(raw->base->transform());
    if (!from.region.empty()) {
        const Region region = Region::fromText(from.region, file);
        const openvdb::Coord regionOrigin(region.originVoxels.x, region.originVoxels.y, region.originVoxels.z);
        raw->space = IndexSpace(raw->space.origin() + regionOrigin);
        const Imath::Box3i sides = region.voxelSides();
        raw->sides = raw->space.index(sides);
    }
    try {
        from.seed = std::stoull(optionalText(*meta, "patina_seed"));
    } catch (const std::exception&) {
        throw RunError(file, "its metadata 'patina_seed' is not a number");
    }
    return volume;
}

std::vector<GridSummary> summarizeGrids(const LayerVolume& volume) {
    const NestGrids& grids = volume.grids();
    std::vector<GridSummary> summary;
    const auto add = [&](const std::string& name, const openvdb::GridBase& grid, const char* gridClass) {
        summary.push_back({name, grid.valueType(), gridClass, grid.activeVoxelCount(), grid.memUsage()});
    };
    add("base", *grids.base, "level set");
    if (grids.metal)
        add("metal", *grids.metal, "level set");
    for (int k = 1; k <= volume.layerCount(); ++k)
        add(volume.interfaceGridName(k), *grids.interfaces[k - 1], "level set");
    add("material", *grids.material, "IDs");
    for (const auto& [name, field] : grids.fields)
        add(name, *field, "field");
    return summary;
}

} // namespace patina
