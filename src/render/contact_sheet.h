#pragma once
// Several pictures on one sheet, with labels.

#include "render/image.h"

#include <string>
#include <vector>

namespace patina {

struct LabelledImage {
    Image image;       ///< encoded for display, 3 channels
    std::string label; ///< below the picture; may be empty
};

struct ContactSheetOptions {
    int columns = 0;     ///< 0: as many as make the sheet about as wide as 16:9
    std::string title;   ///< above all pictures; may be empty
    int gap = 12;        ///< pixels between pictures and around them
    int labelHeight = 0; ///< of the letters, pixels; 0: a twentieth of the pictures' height, 12 to 40
    Imath::V3f paper{0.965f, 0.965f, 0.96f}; ///< encoded
    Imath::V3f ink{0.13f, 0.13f, 0.14f};
};

struct ContactSheet {
    Image image;         ///< encoded for display
    bool hasText = true; ///< false where words were wanted and no font was found: they are left out
};

/// Lays pictures out in rows, each centred in a cell of the size of the largest.
/// \throws RunError where there are none, or one is empty or has not 3 channels.
ContactSheet makeContactSheet(const std::vector<LabelledImage>& images, const ContactSheetOptions& options = {});

/// A sheet with nothing on it but its title: what the layouts of several pictures begin with.
/// \param height   pixels below the title
/// \param letters  height of labels, pixels; the title's are half as high again
/// \param top      receives the rows that the title takes
ContactSheet makeEmptySheet(int width, int height, int letters, const ContactSheetOptions& options, int& top);

enum class TextAlign { left, centre, right };

/// Draws one line of text; (x, y) is the left end, middle or right end of its baseline. Text wider than `maxWidth`
/// (where that is above 0) is drawn smaller, down to half its height, then without its last words.
/// \returns false where no font was found.
bool drawText(Image& image, const std::string& text, float x, float y, int height, const Imath::V3f& ink,
              TextAlign align = TextAlign::left, float maxWidth = 0.f);

} // namespace patina
