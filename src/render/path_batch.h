#pragma once
// The paths of a block of pixels, traced together surface by surface: rays in packets and streams, shading lane by
// lane.

#include "base/random.h"
#include "base/vector_lanes.h"
#include "optics/bsdf_batch.h"
#include "render/block_noise.h"
#include "render/block_sampler.h"
#include "render/camera.h"
#include "render/image.h"
#include "render/lights.h"
#include "render/path_tracer.h"
#include "render/stage.h"
#include "surface/ray_batch.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace patina {

/// What all paths of a picture share.
struct PathSetting {
    const Stage& stage;
    const Lights& lights;
    const RenderOptions& options;
};

/// Keeps its storage from one block to the next; one for each thread.
class PathBatch {
  public:
    static constexpr int size = 8; ///< pixels each way

    /// What a picture, or a part of it, cost.
    struct Work {
        std::uint64_t rays = 0;
        std::uint64_t samples = 0; ///< of all pixels together
    };

    PathBatch(const PathSetting& setting, const Camera& camera, const KeyedRandom& random);

    /// Adds samples first … last - 1 of each pixel of the block, which begins at (left, top), to its sum.
    /// Batches hold samples 2^k … 2^(k+1) - 1 of all pixels, or 16 from a multiple of 16 on: a picture's bits do not
    /// depend on where rounds of samples begin and end, if they do so there.
    /// With `RenderOptions::noise`, where first is 0, it ends sooner; the sums are then as large as if it had not.
    /// \param work  what it cost is added to
    void addSamples(Image& image, int left, int top, int first, int last, Work& work);

  private:
    /// Draws that a surface takes: which light, three lights, two for a direction, roulette. Before them comes the
    /// camera's.
    static constexpr int drawsPerVertex = 7;

    /// Paths that go on, side by side: a ray for each, and what the surface that it left knows.
    struct Wave {
        RayBatch rays;
        std::vector<int> path; ///< of the batch
        VectorLanes throughput;
        std::vector<float> directionPdf; ///< of the ray, by its BSDF
        std::vector<int> aims;           ///< table of lights for the surface that the ray left
        VectorLanes normal;              ///< of that surface
        std::vector<char> lightsDone;    ///< that surface has all direct light already

        void resize(std::size_t count);
    };

    /// The camera's rays, as a wave.
    void aim(int first, int last);
    /// Lanes to shade, of what the wave's rays met; the light of those that end there is added.
    void arrive();
    void arriveAtFloor(std::size_t ray);
    /// The light of the paths that leave the scene.
    void leaveScene();
    /// Light in the scene that a ray passed before it met what is `farthest` away.
    void meetAreaLights(std::size_t ray, float farthest);
    /// Light times what is left of it, bounded where it is indirect.
    void add(int path, const Imath::V3f& throughput, const Imath::V3f& light, bool indirect);
    /// Light sampled from each lane.
    void lookAtLights();
    /// One look from each lane, at its source. \param draw  number of the draw
    /// \param part  of the `parts` looks that share this draw
    void look(int draw, int part = 0, int parts = 1);
    void sampleLight(std::size_t lane);
    /// The next wave: a direction for each lane.
    void goOn();

    const PathSetting& setting_;
    const Camera& camera_;
    const int lensDraw_; ///< behind those of a path's surfaces
    BlockSampler sampler_;
    std::vector<Imath::V2i> pixels_;
    BlockNoise noise_;
    VectorLanes light_; ///< of each path
    int depth_ = 0;
    std::uint64_t rays_ = 0;
    CameraRays cameraRays_;

    Wave wave_, next_;
    HitBatch hits_;
    std::size_t lanes_ = 0;                    ///< places to shade
    std::vector<int> from_;                    ///< of each: its ray
    std::vector<std::size_t> floor_, leaving_; ///< rays that met the floor, and nothing
    SurfaceLanes at_;
    std::vector<int> path_;
    VectorLanes throughput_, wo_, wi_, value_, numbers_, direction_, radiance_, arriving_;
    std::vector<float> pdf_, density_, distance_, most_, weight_, roulette_;
    std::vector<char> lightsDone_;
    std::vector<int> aims_, leavingAims_;
    std::vector<Lights::Source> sources_;
    BsdfBatch bsdfs_;

    RayBatch shadows_;
    std::vector<int> shadowPath_;
    VectorLanes shadowLight_;
    std::vector<char> blocked_;
};

} // namespace patina
