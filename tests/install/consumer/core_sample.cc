// core-sample VOLUME X Y Z NX NY NZ DATA: the layers under a point of the model, and their colour.

#include "optics/colour.h"
#include "optics/layer_stack.h"
#include "optics/material_library.h"
#include "volume/stack_probe.h"
#include "volume/vdb_file.h"

#include <cstdio>
#include <cstdlib>

int main(int count, char** words) {
    if (count != 9)
        return 2;
    const auto number = [&](int i) { return std::atof(words[i]); };
    patina::initializeVolumes();
    const patina::LayerVolume volume = patina::readVolume(words[1]);
    std::vector<double> um(volume.layerCount());
    const auto reading = patina::StackProbe(volume).read({number(2), number(3), number(4)},
                                                         {number(5), number(6), number(7)}, um.data());
    if (!reading.found)
        return 1;

    const auto materials = patina::MaterialLibrary::load(words[8]);
    std::vector<const patina::Material*> stack{&materials.at(volume.metal())};
    for (int k = 0; k < volume.layerCount(); ++k) {
        stack.push_back(&materials.at(volume.layers()[k]));
        std::printf("%s %.3f um\n", volume.layers()[k].c_str(), um[k]);
    }
    patina::Appearance look;
    patina::StackOptics(stack).evaluate(std::vector<float>(um.begin(), um.end()).data(), look);
    std::printf("colour %s\n", patina::srgbHex(Imath::V3d(look.baseColour)).c_str());
}
