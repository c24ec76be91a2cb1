#pragma once
// The schematic diagram of how patinas grow: one column for each environment, its stages from the bare metal down
// (Dorsey & Hanrahan 1996, figure 2).

#include "render/contact_sheet.h"

#include <string>
#include <vector>

namespace patina::tool {

struct DiagramColour {
    std::string name;
    Imath::V3f colour;  ///< encoded for display
    double share = 1.0; ///< of a mixture
};

struct DiagramStage {
    DiagramColour layer;              ///< what this stage adds on top
    std::vector<std::string> when;    ///< lines: "years 2 to 10"
    std::vector<DiagramColour> parts; ///< what it is a mixture of; may be empty
};

struct DiagramColumn {
    std::string title;
    DiagramColour metal;
    std::vector<DiagramStage> stages;
};

/// \param key    colours of single minerals, below
/// \param width  pixels
ContactSheet drawStageDiagram(const std::vector<DiagramColumn>& columns, const std::vector<DiagramColour>& key,
                              int width);

} // namespace patina::tool
