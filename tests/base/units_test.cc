#include "base/units.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

TEST(Units, AreKnownByTheirNames) {
    EXPECT_EQ(micrometresPerUnit("nm"), 1e-3);
    EXPECT_EQ(micrometresPerUnit("mm"), 1e3);
    EXPECT_EQ(micrometresPerUnit("m"), 1e6);
    EXPECT_FALSE(micrometresPerUnit("furlong"));
}

TEST(Units, LengthsReadWell) {
    EXPECT_EQ(readableLength(0.35), "0.35 µm");
    EXPECT_EQ(readableLength(0.012), "12 nm");
    EXPECT_EQ(readableLength(390.6), "391 µm");
    EXPECT_EQ(readableLength(2e5), "20 cm");
    EXPECT_EQ(readableLength(4.2e6), "4.2 m");
    EXPECT_EQ(readableLength(0.0), "0 µm");
}

TEST(Units, BytesReadWell) {
    EXPECT_EQ(readableBytes(512), "512 B");
    EXPECT_EQ(readableBytes(1.5 * 1024 * 1024 * 1024), "1.5 GiB");
}

} // namespace
} // namespace patina
