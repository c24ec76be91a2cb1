#pragma once
// The BRDFs of many points at once, each seen from one direction.

#include "base/vector_lanes.h"
#include "optics/patina_bsdf.h"

#include <Imath/ImathVec.h>

#include <cstddef>
#include <vector>

namespace patina {

struct BsdfLanes;

/// What SeenBsdf says of one point, for many: lane by lane in wide registers, to the bit the same. Filled by begin()
/// and set() or rows(), then seen(), then asked. Not to be shared between threads; its memory is kept.
class BsdfBatch {
  public:
    /// Lanes come in groups of this many: arrays are read and written up to the end of the last group, whose spare
    /// lanes may hold anything.
    static constexpr std::size_t group = 16;
    static constexpr std::size_t padded(std::size_t count) { return (count + group - 1) / group * group; }

    void begin(std::size_t count);
    /// Room for this many lobes, those added black; before rows(). set() takes what it needs.
    void need(int lobes);
    void set(std::size_t lane, const PatinaBsdf& bsdf);
    std::size_t count() const { return count_; }

    /// One lobe of all lanes, for who fills them in by itself, black lobes included. `body` and `bodyEdge` are without
    /// the air's part, as in PatinaBsdf.
    struct LobeRows {
        float *bodyX, *bodyY, *bodyZ, *bodyEdgeX, *bodyEdgeY, *bodyEdgeZ, *air, *airEdge;
        float *alpha, *exponent, *rowWeight;
        int* rowBelow;
    };
    LobeRows rows(int lobe);
    VectorLanes& diffuse() { return diffuse_; }
    float* meanAir() { return meanAir_.data(); }
    float* leastAir() { return leastAir_.data(); }
    /// After rows() are filled in, of the first `count` lanes.
    void normalise(OpticsModel model, std::size_t count);

    /// Looks at them from these unit directions, each in its lane's local frame. Arrays of padded(count()) lanes, as
    /// all below.
    void seenFrom(const VectorLanes& wo);
    /// f, 1/sr, without the cosine, and the density of drawing wi, 1/sr.
    void evaluate(const VectorLanes& wi, VectorLanes& value, std::vector<float>& pdf);
    /// Draws a direction for each lane, and evaluates there. Where nothing can be drawn, the density is 0.
    /// \param u  three uniforms in [0, 1)
    void sample(const VectorLanes& u, VectorLanes& wi, VectorLanes& value, std::vector<float>& pdf);

  private:
    float* field(int lobe, int field) { return numbers_.data() + place(lobe, field); }
    std::size_t place(int lobe, int field) const;
    BsdfLanes lanes();
    BsdfValue evaluatePaper(std::size_t lane, const Imath::V3f& wi);
    Imath::V3f samplePaper(std::size_t lane, const Imath::V3f& u);

    std::size_t count_ = 0;
    std::size_t stride_ = 0;
    int lobes_ = 0;
    bool anyAir_ = false, anyPaper_ = false;
    std::vector<float> numbers_; ///< lobe by lobe, number by number (bsdf_kernels.h), lane by lane
    std::vector<int> rowBelow_;  ///< lobe by lobe
    VectorLanes diffuse_, wo_;
    std::vector<float> meanAir_, leastAir_, diffuseNormaliser_, passNormaliser_;
    std::vector<float> pass_, diffuseChance_, total_;
    std::vector<char> paper_; ///< of each lane: whether its model is the paper's
};

} // namespace patina
