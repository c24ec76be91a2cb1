#pragma once
// How the built-in shapes are made: grids of quads with a UV chart each, packed side by side at the end.
// Lengths are metres.

#include "surface/mesh.h"

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace patina {

/// Vertices in columns and rows; a column or row may repeat vertices of another one where the grid closes.
/// Seen from outside, columns run to the right and rows upward.
struct VertexGrid {
    int columns = 0; ///< quads across; one vertex more
    int rows = 0;
    std::vector<int> vertices; ///< (rows + 1) * (columns + 1), row by row

    VertexGrid(int columns, int rows);
    int& at(int column, int row) { return vertices[static_cast<std::size_t>(row) * (columns + 1) + column]; }
    int at(int column, int row) const { return vertices[static_cast<std::size_t>(row) * (columns + 1) + column]; }
};

/// A "sock": a tube of quads around an axis, each end closed by a square patch of quads, so that there are no poles.
/// The ring at the end of a tube is the border of the patch, mapped from the square to the disc by
/// (a, b) -> (a sqrt(1 - b²/2), b sqrt(1 - a²/2)), which keeps the patch's quads from pinching anywhere but at its four
/// corners.
struct Sock {
    int across = 8; ///< quads of the end patches along x
    int along = 8;  ///< quads of the end patches along y
    int rows = 8;   ///< quads from the lower to the upper ring

    /// Position of a side vertex: `ring` is the column's point on the unit circle (x to the right of the front, y to
    /// the back, so that the front is (0, -1)), row from 0 (below) to rows.
    std::function<Imath::V3d(Imath::V2d ring, int column, int row)> side;
    /// Position of a patch vertex inside its border: `disc` is a point of the unit disc.
    std::function<Imath::V3d(Imath::V2d disc)> below;
    std::function<Imath::V3d(Imath::V2d disc)> above;

    /// Rows at which the side is cut into charts of their own (a shape whose girth changes much).
    std::vector<int> chartRows;
    double density = 1.0; ///< texels per length against other charts

    int columns() const { return 2 * (across + along); }
    Imath::V2d disc(int a, int b) const; ///< of the patch vertex (a, b)
    Imath::V2d ring(int column) const;   ///< of the side's column, counter-clockwise from the front left corner
};

class ShapeBuilder {
  public:
    explicit ShapeBuilder(std::string name);

    int addVertex(const Imath::V3d& position);
    const Imath::V3d& position(int vertex) const { return positions_[static_cast<std::size_t>(vertex)]; }
    Imath::V3d& position(int vertex) { return positions_[static_cast<std::size_t>(vertex)]; }
    int vertexCount() const { return static_cast<int>(positions_.size()); }

    /// The grid's quads, in a rectangular chart whose columns and rows are as wide as they are on average in space.
    /// `density`: texels per length against other charts.
    void addGrid(const VertexGrid& grid, double density = 1.0);

    void addSock(const Sock& sock);

    /// A box of quads: a sock with square ends, each side with a chart of its own. `position` takes a point of the
    /// surface of the cube [-1, 1]³.
    void addBox(const std::array<int, 3>& quads, const std::function<Imath::V3d(const Imath::V3d&)>& position);

    /// Moves the vertices so that the Catmull-Clark limit surface passes (nearly, after few rounds) through where they
    /// were: subdivision otherwise rounds off folds and features of few quads. Closed meshes only.
    void interpolateLimit(int rounds);

    /// Packs the charts into the unit square, at least 0.01 apart, and hands the mesh over.
    Mesh finish() const;

  private:
    struct Chart {
        Imath::V2d size; ///< metres on the surface, times density
        std::vector<std::array<int, 4>> quads;
        std::vector<std::array<int, 4>> quadUvs;
        std::vector<Imath::V2d> uvs; ///< from (0, 0) to size
    };

    std::string name_;
    std::vector<Imath::V3d> positions_;
    std::vector<Chart> charts_;
};

} // namespace patina
