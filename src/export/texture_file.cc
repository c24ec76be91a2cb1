#include "export/texture_file.h"

#include "base/atomic_file.h"
#include "base/errors.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <fmt/format.h>

#include <sstream>

namespace patina {

void writeTx(const std::filesystem::path& exr, const std::filesystem::path& tx) {
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
    AtomicFile file(tx);
    std::ostringstream said;
    if (!OIIO::ImageBufAlgo::make_texture(OIIO::ImageBufAlgo::MakeTxTexture, image, file.temporary().string(), settings,
                                          &said))
        throw RunError(tx.string(), fmt::format("cannot write the texture: {}", said.str()), "is the disk full?");
    file.commit();
}

} // namespace patina
