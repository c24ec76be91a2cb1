#include "export/texture_file.h"

#include "base/atomic_file.h"
#include "base/errors.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <fmt/format.h>

#include <sstream>

namespace patina {

void makeTx(const std::filesystem::path& exr, const std::filesystem::path& file, const std::filesystem::path& tx) {
    const OIIO::ImageBuf image(exr.string());
    OIIO::ImageSpec settings;
    settings.tile_width = settings.tile_height = 64;
    settings.attribute("maketx:fileformatname", "openexr");
    settings.attribute("compression", "zip");
    settings.attribute("wrapmodes", "clamp,clamp");
    // Heights are no colours: nothing is clamped, guessed or made a constant.
    settings.attribute("maketx:highlightcomp", 0);
    settings.attribute("maketx:constant_color_detect", 0);
    settings.attribute("maketx:monochrome_detect", 0);
    std::ostringstream said;
    if (!OIIO::ImageBufAlgo::make_texture(OIIO::ImageBufAlgo::MakeTxTexture, image, file.string(), settings, &said))
        throw RunError(tx.string(), fmt::format("cannot write the texture: {}", said.str()), "is the disk full?");
}

void writeTx(const std::filesystem::path& exr, const std::filesystem::path& tx) {
    AtomicFile file(tx);
    makeTx(exr, file.temporary(), tx);
    file.commit();
}

} // namespace patina
