#include "surface/mesh_shells.h"

#include "surface/face_list.h"
#include "surface/hole_cap.h"
#include "surface/triangulate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <utility>

namespace patina {

using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

namespace {

V3d vertex(const Mesh& mesh, int corner) {
    return V3d(mesh.positions[mesh.faceVertices[corner]]);
}

/// A face as triangles of vertices, turned if its shell wants it so.
void addTriangles(const Mesh& mesh, const std::vector<int>& starts, int face, bool reverse,
                  std::vector<V3i>& triangles) {
    std::vector<V3i> local;
    const int* corners = mesh.faceVertices.data() + starts[face];
    triangulatePolygon(mesh.positions, corners, starts[face + 1] - starts[face], local);
    for (const V3i& t : local)
        triangles.emplace_back(corners[t.x], corners[reverse ? t.z : t.y], corners[reverse ? t.y : t.z]);
}

/// Closes, in thought, what is open of a shell.
void gatherHoles(const Mesh& mesh, const std::vector<int>& starts, const MeshTopology& topology,
                 std::unordered_set<std::uint64_t>& edges, int s, MeshShell& shell) {
    if (edges.empty())
        for (std::size_t f = 0; f < mesh.faceCount(); ++f)
            for (int c = starts[f]; c < starts[f + 1]; ++c) {
                const int next = c + 1 < starts[f + 1] ? c + 1 : starts[f];
                edges.insert(edgeKey(topology.place(mesh.faceVertices[c]), topology.place(mesh.faceVertices[next])));
            }
    const auto loops = topology.openLoops(s);
    std::size_t sides = 0;
    for (const auto& loop : loops) {
        ShellHole hole;
        // Against the faces' way, each corner as the face has it whose side begins there.
        for (auto side = loop.rbegin(); side != loop.rend(); ++side)
            for (int c = starts[side->face]; c < starts[side->face + 1]; ++c)
                if (topology.place(mesh.faceVertices[c]) == side->from) {
                    hole.corners.push_back(c);
                    break;
                }
        sides += loop.size();
        std::vector<V3f> rim;
        for (const int c : hole.corners) {
            rim.push_back(mesh.positions[mesh.faceVertices[c]]);
            hole.centre += V3d(rim.back()) / static_cast<double>(hole.corners.size());
        }
        hole.triangles = capHole(rim, [&](int a, int b) {
            return edges.count(edgeKey(topology.place(mesh.faceVertices[hole.corners[a]]),
                                       topology.place(mesh.faceVertices[hole.corners[b]]))) == 0;
        });
        for (const V3i& t : hole.triangles)
            hole.area += 0.5 * (V3d(rim[t.y]) - V3d(rim[t.x])).cross(V3d(rim[t.z]) - V3d(rim[t.x])).length();
        for (std::size_t i = 0; i < rim.size(); ++i)
            hole.length += (V3d(rim[i]) - V3d(rim[(i + 1) % rim.size()])).length();
        shell.holes.push_back(std::move(hole));
    }
    shell.closable = sides == topology.openSides(s).size();
}

std::vector<V3i> trianglesOf(const std::vector<MeshShell>& shells) {
    std::vector<V3i> triangles;
    for (const MeshShell& shell : shells)
        triangles.insert(triangles.end(), shell.triangles.begin(), shell.triangles.end());
    return triangles;
}

} // namespace

bool MeshShell::isFlat() const {
    return std::abs(volume) < 1e-6 * area * std::sqrt(area);
}

void MeshShell::closeHoles(const Mesh& mesh) {
    closed = true;
    for (const ShellHole& hole : holes)
        for (const V3i& t : hole.triangles) {
            V3i triangle(mesh.faceVertices[hole.corners[t.x]], mesh.faceVertices[hole.corners[t.y]],
                         mesh.faceVertices[hole.corners[t.z]]);
            if (volume < 0.0)
                std::swap(triangle.y, triangle.z);
            triangles.push_back(triangle);
        }
}

std::vector<MeshShell> gatherShells(const Mesh& mesh, const std::vector<int>& starts, const MeshTopology& topology) {
    std::vector<MeshShell> shells(std::size_t(topology.shellCount()));
    std::unordered_set<std::uint64_t> edges;
    for (std::size_t f = 0; f < mesh.faceCount(); ++f)
        if (topology.shellOf(f) >= 0)
            shells[topology.shellOf(f)].faces.push_back(static_cast<int>(f));
    for (std::size_t s = 0; s < shells.size(); ++s) {
        MeshShell& shell = shells[s];
        shell.low = V3d(1e300);
        shell.high = V3d(-1e300);
        for (const int f : shell.faces) {
            addTriangles(mesh, starts, f, topology.turned(f), shell.triangles);
            for (int c = starts[f]; c < starts[f + 1]; ++c)
                for (int axis = 0; axis < 3; ++axis) {
                    shell.low[axis] = std::min(shell.low[axis], vertex(mesh, c)[axis]);
                    shell.high[axis] = std::max(shell.high[axis], vertex(mesh, c)[axis]);
                }
        }
        shell.closed = topology.openSides(static_cast<int>(s)).empty();
        if (!shell.closed)
            gatherHoles(mesh, starts, topology, edges, static_cast<int>(s), shell);
        const V3d centre = (shell.low + shell.high) * 0.5;
        const auto volumeOf = [&](const V3d& a, const V3d& b, const V3d& c) {
            return (a - centre).dot((b - centre).cross(c - centre)) / 6.0;
        };
        for (const V3i& t : shell.triangles) {
            const V3d a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
            shell.area += 0.5 * (b - a).cross(c - a).length();
            shell.volume += volumeOf(a, b, c);
        }
        for (const ShellHole& hole : shell.holes)
            for (const V3i& t : hole.triangles)
                shell.volume += volumeOf(vertex(mesh, hole.corners[t.x]), vertex(mesh, hole.corners[t.y]),
                                         vertex(mesh, hole.corners[t.z]));
        if (shell.volume < 0.0)
            for (V3i& t : shell.triangles)
                std::swap(t.y, t.z);
    }
    return shells;
}

ShellInside::ShellInside(const Mesh& mesh, const std::vector<MeshShell>& shells)
    : mesh_(mesh), everything_(mesh.positions, trianglesOf(shells)) {}

double ShellInside::definedFraction(const MeshShell& shell) const {
    double defined = 0.0, all = 0.0;
    const std::size_t step = std::max<std::size_t>(1, shell.triangles.size() / 256);
    for (std::size_t i = 0; i < shell.triangles.size(); i += step) {
        const V3i& t = shell.triangles[i];
        const V3d a(mesh_.positions[t.x]), b(mesh_.positions[t.y]), c(mesh_.positions[t.z]);
        const V3d cross = (b - a).cross(c - a);
        const double twice = cross.length();
        if (twice <= 0.0)
            continue;
        const double w = everything_.at((a + b + c) / 3.0 - cross / twice * (1e-3 * std::sqrt(twice)));
        all += twice;
        if (w > 0.7 && std::abs(w - std::round(w)) < 0.3)
            defined += twice;
    }
    return all > 0.0 ? defined / all : 0.0;
}

double ShellInside::openFraction(const MeshShell& shell) const {
    double open = 0.0;
    for (const ShellHole& hole : shell.holes)
        for (const V3i& t : hole.triangles) {
            const V3d a = vertex(mesh_, hole.corners[t.x]), b = vertex(mesh_, hole.corners[t.y]),
                      c = vertex(mesh_, hole.corners[t.z]);
            if (hole.triangles.size() > 64 || everything_.at((a + b + c) / 3.0) < 0.75)
                open += 0.5 * (b - a).cross(c - a).length();
        }
    return open / shell.area;
}

} // namespace patina
