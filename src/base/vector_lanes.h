#pragma once
// Many vectors, number by number: what loops over lanes work on.

#include <Imath/ImathVec.h>

#include <cstddef>
#include <vector>

namespace patina {

/// Coordinates of vectors in three arrays. resize() keeps what is there and never gives memory back.
struct VectorLanes {
    std::vector<float> x, y, z;

    void resize(std::size_t count) {
        x.resize(count);
        y.resize(count);
        z.resize(count);
    }
    std::size_t size() const { return x.size(); }
    Imath::V3f operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
    void set(std::size_t i, const Imath::V3f& v) {
        x[i] = v.x;
        y[i] = v.y;
        z[i] = v.z;
    }
};

/// The same arrays as loops over lanes take them.
struct ConstVectors {
    const float *x, *y, *z;
};
struct Vectors {
    float *x, *y, *z;
};
inline Vectors numbersOf(VectorLanes& v) {
    return {v.x.data(), v.y.data(), v.z.data()};
}
inline ConstVectors numbersOf(const VectorLanes& v) {
    return {v.x.data(), v.y.data(), v.z.data()};
}

} // namespace patina
