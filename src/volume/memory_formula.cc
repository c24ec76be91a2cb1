#include "volume/memory_formula.h"

#include "volume/nest_grids.h"

namespace patina {

double leafValueBytes(const LayerVolume& volume) {
    const double grids = volume.layerCount() + 2.0 + (volume.grids().metal ? 1.0 : 0.0);
    return 4.0 * 512.0 * static_cast<double>(volume.leafCount()) * grids;
}

double memoryOfFormula(const LayerVolume& volume) {
    double bytes = static_cast<double>(volume.memoryBytes());
    for (const auto& field : volume.grids().fields)
        bytes -= static_cast<double>(field.second->memUsage());
    return bytes / leafValueBytes(volume);
}

} // namespace patina
