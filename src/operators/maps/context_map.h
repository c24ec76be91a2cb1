#pragma once
// A field of the whole model as a map of a close-up.

#include "operators/maps/thickness_map.h"
#include "volume/region_context.h"

#include <string>

namespace patina {

/// Asked in the model's coordinates. Null where the whole model's volume has no field of this name.
/// \param fields  must outlive the map
ThicknessMapPtr makeContextMap(const ContextFields& fields, const std::string& name);

} // namespace patina
