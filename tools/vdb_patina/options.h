#pragma once
// The command line's options, the same wherever they make sense.

#include "render/frame.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace patina::tool {

struct View;

enum class ProgressStyle { automatic, bar, plain, json, none };

struct Options {
    // Where results go, and how much is said.
    std::string output; ///< folder; empty: one named after the result
    std::string report; ///< file; empty: report.json in the folder
    ProgressStyle progress = ProgressStyle::automatic;
    bool verbose = false;
    bool quiet = false;
    int threads = 0; ///< 0: all

    // The model.
    std::string unit = "m";
    UpAxis up = UpAxis::y;
    std::string scheme = "automatic";
    int subdivide = -1;
    bool atlas = false;
    std::string repair; ///< auto, holes, sheet or none; empty: not given, auto

    // The volume.
    int voxels = 256;
    double voxelSize = 0.0; ///< scene units; 0: from voxels
    double exaggeration = 1.0;
    std::optional<std::uint64_t> seed;
    std::string region;   ///< "x0,y0,z0,x1,y1,z1", scene units; empty: the whole model
    std::string regionAt; ///< "x,y,z,size"
    std::string context;  ///< a volume of the whole model, for its fields

    // The maps and the picture.
    int resolution = 1024;
    bool bakeMaps = true;
    bool keepExaggeration = false;
    bool materialId = false;
    bool foldMask = false;
    bool vectorDisplacement = false;
    bool fields = false;
    bool tx = false;
    std::string optics = "conserving";
    bool thinFilm = false;
    std::string colourSpace = "rec709"; ///< of the maps
    int pictureSize = 640;
    int samples = 32;
    double noise = 0.0; ///< a block of pixels that is less noisy (steps of 8 bits) takes no more samples; 0: it does
    std::optional<double> azimuth;
    std::optional<double> elevation;
    // … of `render` alone:
    std::string from = "mesh";    ///< the surface shown: mesh (displaced) or volume (its interface with the air)
    std::string light = "studio"; ///< studio, sky, overcast, uniform, or a panorama's file
    std::string sun;              ///< "azimuth,altitude", degrees
    double turnLight = 0.0;       ///< degrees about up
    double lightStrength = 1.0;
    std::string camera;  ///< "azimuth,elevation[,distance[,field of view]]"
    std::string closeUp; ///< "x,y,z,size", scene units of the model
    double aspect = 0.0; ///< width over height; 0: the subject's
    double dice = 1.0;   ///< longest edge of the shown mesh, pixels; 0: the model's own triangles
    double fStop = 0.0;  ///< 0: everything is sharp
    bool floor = true;
    bool exr = false;
    std::string viewTransform = "filmic";
    double exposureStops = 0.0;
    double clamp = 6.0;   ///< bound on light of two bounces or more; 0: none
    double seconds = 0.0; ///< to render in; 0: as long as all samples take
    std::shared_ptr<const View> view; ///< one camera for all pictures of a series; null: each its own

    // The run.
    std::vector<std::string> settings; ///< NAME=VALUE
    double budgetGiB = 0.0;            ///< 0: four fifths of this machine's memory
    bool dryRun = false;
    bool force = false;
    bool resume = false;

    // What other programs are given.
    bool upGiven = false;               ///< --up was there: it holds against what a volume says
    bool halfFields = false;            ///< of the .vdb
    bool fog = false;                   ///< NAME_fog.vdb
    bool microMesh = false;             ///< NAME_micro.ply
    std::string vectorSpace = "object"; ///< of vector_displacement.exr

    double metresPerUnit() const;
    std::map<std::string, std::string> settingMap() const;
};

void addGeneralOptions(CLI::App& app, Options& options);
void addOutputOption(CLI::App& app, Options& options);
void addModelOptions(CLI::App& app, Options& options);
void addVolumeOptions(CLI::App& app, Options& options);
void addRegionOptions(CLI::App& app, Options& options);
void addOpticsOptions(CLI::App& app, Options& options);
void addMapOptions(CLI::App& app, Options& options);
/// What a command takes where nothing is given.
struct PictureDefaults {
    int size = 640, samples = 32;
    double noise = 0.0;
};
void addPictureOptions(CLI::App& app, Options& options, const PictureDefaults& defaults = {});
/// Camera, light and files of `render`.
void addRenderOptions(CLI::App& app, Options& options);
/// Puts a command's own defaults where its command line says nothing.
void takeDefaults(const CLI::App& app, const PictureDefaults& defaults, Options& options);
void addRunOptions(CLI::App& app, Options& options);

} // namespace patina::tool
