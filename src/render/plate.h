#pragma once
// A figure laid out on a grid: pictures of different sizes, some over several rows or columns.

#include "render/contact_sheet.h"

namespace patina {

/// A picture and the cells that it takes, from (0, 0) at the top left.
struct PlacedImage {
    LabelledImage picture;
    int row = 0, column = 0;
    int rows = 1, columns = 1;
};

/// Rows and columns are as large as the pictures in them ask for; one that spans several is centred over them, and
/// where it is larger than all of them together they share the rest evenly. `options.columns` is not used. \throws
/// RunError where there is no picture, one is empty or not RGB, two take the same cell, or a place is outside 0…99
ContactSheet makePlate(const std::vector<PlacedImage>& images, const ContactSheetOptions& options = {});

} // namespace patina
