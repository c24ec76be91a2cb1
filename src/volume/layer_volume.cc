#include "volume/layer_volume.h"

#include "volume/nest_grids.h"

#include <fmt/format.h>

#include <algorithm>

namespace patina {

std::vector<const openvdb::FloatGrid*> NestGrids::nest() const {
    std::vector<const openvdb::FloatGrid*> all{&floor()};
    for (const auto& interface : interfaces)
        all.push_back(interface.get());
    return all;
}

openvdb::FloatGrid::Ptr makeGridLike(const openvdb::FloatGrid& grid, float value) {
    auto tree = std::make_shared<openvdb::FloatTree>(grid.tree(), value, openvdb::TopologyCopy());
    auto copy = openvdb::FloatGrid::create(tree);
    copy->setTransform(grid.transform().copy());
    return copy;
}

LayerVolume::LayerVolume(VolumeScale scale, std::string metal, std::unique_ptr<NestGrids> grids)
    : scale_(scale), palette_{"air", std::move(metal)}, grids_(std::move(grids)) {}

LayerVolume::~LayerVolume() = default;
LayerVolume::LayerVolume(LayerVolume&&) noexcept = default;
LayerVolume& LayerVolume::operator=(LayerVolume&&) noexcept = default;

LayerVolume LayerVolume::clone() const {
    auto grids = std::make_unique<NestGrids>();
    grids->base = grids_->base->deepCopy();
    if (grids_->metal)
        grids->metal = grids_->metal->deepCopy();
    for (const auto& interface : grids_->interfaces)
        grids->interfaces.push_back(interface->deepCopy());
    if (grids_->material)
        grids->material = grids_->material->deepCopy();
    for (const auto& [name, field] : grids_->fields)
        grids->fields[name] = field->deepCopy();
    grids->space = grids_->space;
    grids->sides = grids_->sides;
    grids->interiorBand = grids_->interiorBand;
    grids->exteriorBand = grids_->exteriorBand;
    LayerVolume copy(scale_, metal(), std::move(grids));
    copy.palette_ = palette_;
    copy.layers_ = layers_;
    copy.provenance = provenance;
    return copy;
}

std::int32_t LayerVolume::findMaterialId(const std::string& material) const {
    const auto found = std::find(palette_.begin() + 1, palette_.end(), material);
    return found == palette_.end() ? 0 : static_cast<std::int32_t>(found - palette_.begin());
}

std::int32_t LayerVolume::materialId(const std::string& material) {
    if (const std::int32_t id = findMaterialId(material))
        return id;
    palette_.push_back(material);
    return static_cast<std::int32_t>(palette_.size()) - 1;
}

std::string LayerVolume::interfaceGridName(int k) const {
    return fmt::format("interface_{:02d}_{}", k, layers_[k - 1]);
}

void LayerVolume::pushLayer(const std::string& material) {
    grids_->interfaces.push_back(grids_->surface().deepCopy());
    nameTopLayer(material);
}

void LayerVolume::nameTopLayer(const std::string& material) {
    materialId(material);
    layers_.push_back(material);
}

void LayerVolume::splitLayer(int k, const std::string& outer) {
    materialId(outer);
    grids_->interfaces.insert(grids_->interfaces.begin() + k, grids_->interfaces[k - 1]->deepCopy());
    layers_.insert(layers_.begin() + k, outer);
}

void LayerVolume::removeLayer(int k) {
    grids_->interfaces.erase(grids_->interfaces.begin() + (k - 1));
    layers_.erase(layers_.begin() + (k - 1));
}

std::size_t LayerVolume::activeVoxels() const {
    return grids_->base->activeVoxelCount();
}
std::size_t LayerVolume::leafCount() const {
    return grids_->base->tree().leafCount();
}

std::size_t LayerVolume::memoryBytes() const {
    std::size_t bytes = grids_->base->memUsage();
    if (grids_->metal)
        bytes += grids_->metal->memUsage();
    for (const auto& interface : grids_->interfaces)
        bytes += interface->memUsage();
    if (grids_->material)
        bytes += grids_->material->memUsage();
    for (const auto& field : grids_->fields)
        bytes += field.second->memUsage();
    return bytes;
}

} // namespace patina
