#include "operators/maps/image_channels.h"

#include <OpenImageIO/imageio.h>

namespace patina {

ImageChannels::ImageChannels(const std::filesystem::path& file) {
    if (const auto input = OIIO::ImageInput::open(file.string()))
        names_ = input->spec().channelnames;
    else
        failure_ = OIIO::geterror();
}

std::optional<int> ImageChannels::find(const std::string& channel) const {
    for (std::size_t c = 0; c < names_.size(); ++c)
        if (names_[c] == channel || std::to_string(c) == channel)
            return static_cast<int>(c);
    return std::nullopt;
}

} // namespace patina
