#include "render/block_sampler.h"

#include "render/pixel_sampler.h"

#include <gtest/gtest.h>

#include <array>

namespace patina {
namespace {

// In any order of the paths, and for a second block in the same memory.
TEST(BlockSampler, drawsWhatEachPixelDraws) {
    const KeyedRandom random(5, "block", "test");
    BlockSampler block(random);
    for (const int corner : {0, 700}) {
        const std::vector<Imath::V2i> pixels{{corner, 2}, {corner + 1, 2}, {corner, 3}};
        block.begin(pixels);
        for (const int first : {0, 5, 1 << 20}) {
            block.take(first, first + 7);
            ASSERT_EQ(block.paths(), 21u);
            std::vector<int> path(32, 0);
            for (int i = 0; i < 21; ++i)
                path[std::size_t(i)] = (i * 8) % 21;
            std::vector<float> u(32), v(32);
            for (const auto& [draw, part, parts] :
                 {std::array{3, 0, 1}, {0, 0, 1}, {11, 0, 1}, {11, 1, 2}, {2, 0, 2}}) {
                block.draw(draw, path, 21, u.data(), v.data(), part, parts);
                for (std::size_t i = 0; i < 21; ++i) {
                    const Imath::V2i& pixel = pixels[std::size_t(path[i] / 7)];
                    PixelSampler one(random, pixel.x, pixel.y);
                    one.startSample(std::uint32_t(first + path[i] % 7));
                    one.seek(draw);
                    EXPECT_EQ(Imath::V2f(u[i], v[i]), one.next2(part, parts));
                }
            }
        }
    }
}

} // namespace
} // namespace patina
