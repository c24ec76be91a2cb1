#pragma once
// Makes the pictures of a figure, each from its panel of the plan.

#include "console.h"
#include "figure_plan.h"
#include "optics/material_library.h"
#include "script_run.h"

#include "render/contact_sheet.h"
#include "volume/layer_volume.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace patina::tool {

class FigureMaker {
  public:
    /// \param scale   of the pictures' sides; voxels go with it, samples with its square
    /// \param folder  for scripts and single pictures
    FigureMaker(const Options& options, double scale, std::filesystem::path folder, Console& console);

    /// The frames of a history of weather.
    std::vector<LabelledImage> series(const FigureSeries& what);
    /// \param otherModel  of --model; empty: the panel's own
    LabelledImage panel(const FigurePanel& what, const std::string& otherModel);

  private:
    Options optionsOf(const FigureOptions& what) const;
    Image stages(const FigurePanel& what, const Options& options) const;
    Image diagram(const FigurePanel& what, const Options& options) const;
    Image curves(const FigurePanel& what, const Options& options) const;
    LabelledImage map(const FigurePanel& what, const Options& options);
    Imath::V3f colourOf(const std::string& material) const;
    void make(const FigurePanel& what, const std::string& model, const Options& options);

    // A volume that several panels look at is made once; those that continue go on from it.
    struct MadeVolume {
        std::string key;
        std::unique_ptr<Task> task; ///< whose model the session points to
        std::unique_ptr<RunSession> session;
        std::optional<LayerVolume> volume;
    };

    const Options& options_;
    double scale_;
    std::filesystem::path folder_;
    Console& console_;
    MaterialLibrary materials_;
    MadeVolume made_;
    int pictures_ = 0;
};

} // namespace patina::tool
