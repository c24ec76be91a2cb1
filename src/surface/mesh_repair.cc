#include "surface/mesh_repair.h"

#include "base/errors.h"
#include "surface/hole_cap.h"
#include "surface/mesh_topology.h"
#include "surface/triangulate.h"
#include "surface/weld.h"
#include "surface/winding_number.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <unordered_set>

namespace patina {

using Imath::V3d;
using Imath::V3f;
using Imath::V3i;
using Kind = MeshReport::ShellKind;

namespace {

// Holes of a solid take at most this part of its surface, and this part of the surface must know its inside.
constexpr double mostOpen = 0.1, leastDefined = 0.9;
constexpr std::size_t mostTold = 8; // holes with a line of their own

std::string textOf(const V3f& p) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x, p.y, p.z);
}

std::uint64_t edgeKey(int a, int b) {
    return static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint32_t>(std::max(a, b));
}

std::vector<int> startsOf(const Mesh& mesh) {
    std::vector<int> starts(1, 0);
    for (const int size : mesh.faceSizes)
        starts.push_back(starts.back() + size);
    return starts;
}

/// Edges of the faces that have no second face, vertices counted by `place` or, without, by index.
std::size_t openEdges(const Mesh& mesh, const std::vector<int>* place) {
    std::vector<std::uint64_t> edges;
    std::size_t start = 0;
    for (const int size : mesh.faceSizes) {
        for (int i = 0; i < size; ++i) {
            int a = mesh.faceVertices[start + i], b = mesh.faceVertices[start + (i + 1) % size];
            if (place) {
                a = (*place)[a];
                b = (*place)[b];
            }
            if (a != b)
                edges.push_back(edgeKey(a, b));
        }
        start += size;
    }
    std::sort(edges.begin(), edges.end());
    std::size_t open = 0;
    for (std::size_t i = 0; i < edges.size();) {
        std::size_t j = i;
        while (j < edges.size() && edges[j] == edges[i])
            ++j;
        open += j - i == 1;
        i = j;
    }
    return open;
}

/// Faces that are to be subdivided must share their vertices, or they come apart along their seams.
bool joinVertices(Mesh& mesh) {
    if (std::all_of(mesh.faceSizes.begin(), mesh.faceSizes.end(), [](int size) { return size == 3; }))
        return false;
    const std::vector<int> place = weldedIndices(mesh.positions);
    bool split = false;
    for (std::size_t i = 0; i < place.size(); ++i) {
        if (place[i] == static_cast<int>(i))
            continue;
        split = true;
        for (const auto& attribute : mesh.vertexAttributes)
            if (attribute.second[i] != attribute.second[place[i]])
                return false;
    }
    if (!split || openEdges(mesh, &place) >= openEdges(mesh, nullptr))
        return false;
    for (int& vertex : mesh.faceVertices)
        vertex = place[vertex];
    for (Crease& crease : mesh.creases)
        crease = {place[crease.a], place[crease.b], crease.sharpness};
    for (SharpCorner& corner : mesh.corners)
        corner.vertex = place[corner.vertex];
    return true;
}

/// Sheets that are there twice, once for each side: the second copies of the faces of patches that touch no others.
std::vector<int> backsOfDoubleSheets(const Mesh& mesh, const std::vector<int>& starts, const MeshTopology& topology) {
    std::vector<int> pairOf(mesh.faceCount(), -1), patch;
    std::vector<int> backs;
    for (const auto& copy : topology.copies())
        if (copy.opposite && pairOf[copy.face] < 0 && pairOf[copy.of] < 0) {
            pairOf[copy.face] = pairOf[copy.of] = static_cast<int>(backs.size());
            backs.push_back(copy.face);
        }
    if (backs.empty())
        return backs;
    patch.resize(backs.size());
    for (std::size_t i = 0; i < patch.size(); ++i)
        patch[i] = static_cast<int>(i);
    const auto find = [&](int i) {
        while (patch[i] != i)
            i = patch[i] = patch[patch[i]];
        return i;
    };
    // Per edge a pair that has it; patches with an edge of another face are walls, not sheets.
    std::unordered_map<std::uint64_t, int> pairAt;
    std::vector<char> wall(backs.size(), 0);
    for (const bool pairs : {true, false})
        for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
            if ((pairOf[f] >= 0) != pairs)
                continue;
            const int size = starts[f + 1] - starts[f];
            for (int c = 0; c < size; ++c) {
                const auto key = edgeKey(topology.place(mesh.faceVertices[starts[f] + c]),
                                         topology.place(mesh.faceVertices[starts[f] + (c + 1) % size]));
                if (!pairs) {
                    const auto found = pairAt.find(key);
                    if (found != pairAt.end())
                        wall[find(found->second)] = 1;
                    continue;
                }
                const int a = find(pairAt.emplace(key, pairOf[f]).first->second), b = find(pairOf[f]);
                patch[std::max(a, b)] = std::min(a, b);
            }
        }
    backs.erase(std::remove_if(backs.begin(), backs.end(), [&](int f) { return wall[find(pairOf[f])] != 0; }),
                backs.end());
    return backs;
}

void removeFaces(Mesh& mesh, const std::vector<int>& faces) {
    std::vector<char> gone(mesh.faceCount(), 0);
    for (const int f : faces)
        gone[f] = 1;
    Mesh kept;
    std::size_t corner = 0;
    for (std::size_t f = 0; f < gone.size(); corner += mesh.faceSizes[f], ++f) {
        if (gone[f])
            continue;
        kept.faceSizes.push_back(mesh.faceSizes[f]);
        const auto from = static_cast<std::ptrdiff_t>(corner), to = from + mesh.faceSizes[f];
        kept.faceVertices.insert(kept.faceVertices.end(), mesh.faceVertices.begin() + from,
                                 mesh.faceVertices.begin() + to);
        if (mesh.hasUvs())
            kept.faceUvs.insert(kept.faceUvs.end(), mesh.faceUvs.begin() + from, mesh.faceUvs.begin() + to);
    }
    mesh.faceSizes = std::move(kept.faceSizes);
    mesh.faceVertices = std::move(kept.faceVertices);
    mesh.faceUvs = std::move(kept.faceUvs);
}

struct Hole {
    std::vector<int> corners; ///< of the mesh, round the closing triangles
    std::vector<V3i> triangles; ///< of corner numbers
    double area = 0.0;
    double length = 0.0;
    V3d centre{0.0};
};

struct Shell {
    std::vector<int> faces;
    std::vector<Hole> holes;
    bool closable = true; ///< its open sides are loops
    bool closed = true;   ///< has no open sides, or they are closed
    double area = 0.0;
    double volume = 0.0; ///< signed, as the file winds it, holes closed
    V3d low, high;
    bool outward = true; ///< how it shall lie
    int parent = -1;
    bool drop = false;
    std::vector<V3i> triangles; ///< of vertices, facing outward, holes closed
};

class Repair {
  public:
    Repair(Mesh& mesh, RepairMode mode)
        : mesh_(mesh), mode_(mode), starts_(startsOf(mesh)),
          topology_(mesh.positions, starts_, mesh.faceVertices.data()) {}

    /// \param changes  what was done to the mesh before
    MeshReport run(const std::vector<std::string>& changes) {
        for (const std::string& text : changes)
            change(text);
        gatherShells();
        noteFaults();
        classify();
        dropFlatShells();
        nest();
        describeShells();
        apply();
        return std::move(report_);
    }

  private:
    V3d vertex(int corner) const { return V3d(mesh_.positions[mesh_.faceVertices[corner]]); }
    std::string faceText(int face) const {
        return fmt::format("face {}, at {}", face + 1, textOf(mesh_.positions[mesh_.faceVertices[starts_[face]]]));
    }
    std::string edgeText(const MeshTopology::Side& side) const {
        return fmt::format("vertices {} and {}, at {}", side.from + 1, side.to + 1, textOf(mesh_.positions[side.from]));
    }
    void change(const std::string& what) {
        report_.repaired = true;
        report_.warnings.push_back(what);
    }

    /// A face as triangles of vertices, turned if its shell wants it so.
    void addTriangles(int face, bool reverse, std::vector<V3i>& triangles) const {
        std::vector<V3i> local;
        const int* corners = mesh_.faceVertices.data() + starts_[face];
        triangulatePolygon(mesh_.positions, corners, starts_[face + 1] - starts_[face], local);
        for (const V3i& t : local)
            triangles.emplace_back(corners[t.x], corners[reverse ? t.z : t.y], corners[reverse ? t.y : t.z]);
    }

    void gatherShells() {
        shells_.resize(topology_.shellCount());
        for (std::size_t f = 0; f < mesh_.faceCount(); ++f)
            if (topology_.shellOf(f) >= 0)
                shells_[topology_.shellOf(f)].faces.push_back(static_cast<int>(f));
        for (std::size_t s = 0; s < shells_.size(); ++s) {
            Shell& shell = shells_[s];
            shell.low = V3d(1e300);
            shell.high = V3d(-1e300);
            for (const int f : shell.faces) {
                addTriangles(f, topology_.turned(f), shell.triangles);
                for (int c = starts_[f]; c < starts_[f + 1]; ++c)
                    for (int axis = 0; axis < 3; ++axis) {
                        shell.low[axis] = std::min(shell.low[axis], vertex(c)[axis]);
                        shell.high[axis] = std::max(shell.high[axis], vertex(c)[axis]);
                    }
            }
            shell.closed = topology_.openSides(static_cast<int>(s)).empty();
            if (!shell.closed)
                gatherHoles(static_cast<int>(s));
            const V3d centre = (shell.low + shell.high) * 0.5;
            const auto volumeOf = [&](const V3d& a, const V3d& b, const V3d& c) {
                return (a - centre).dot((b - centre).cross(c - centre)) / 6.0;
            };
            for (const V3i& t : shell.triangles) {
                const V3d a(mesh_.positions[t.x]), b(mesh_.positions[t.y]), c(mesh_.positions[t.z]);
                shell.area += 0.5 * (b - a).cross(c - a).length();
                shell.volume += volumeOf(a, b, c);
            }
            for (const Hole& hole : shell.holes)
                for (const V3i& t : hole.triangles)
                    shell.volume += volumeOf(vertex(hole.corners[t.x]), vertex(hole.corners[t.y]), vertex(hole.corners[t.z]));
            if (shell.volume < 0.0)
                for (V3i& t : shell.triangles)
                    std::swap(t.y, t.z);
        }
    }

    bool isFlat(const Shell& shell) const {
        return std::abs(shell.volume) < 1e-6 * shell.area * std::sqrt(shell.area);
    }

    void gatherHoles(int s) {
        Shell& shell = shells_[s];
        if (edges_.empty())
            for (std::size_t f = 0; f < mesh_.faceCount(); ++f)
                for (int c = starts_[f]; c < starts_[f + 1]; ++c) {
                    const int next = c + 1 < starts_[f + 1] ? c + 1 : starts_[f];
                    edges_.insert(edgeKey(topology_.place(mesh_.faceVertices[c]),
                                          topology_.place(mesh_.faceVertices[next])));
                }
        const auto loops = topology_.openLoops(s);
        std::size_t sides = 0;
        for (const auto& loop : loops) {
            Hole hole;
            // Against the faces' way, each corner as the face has it whose side begins there.
            for (auto side = loop.rbegin(); side != loop.rend(); ++side)
                for (int c = starts_[side->face]; c < starts_[side->face + 1]; ++c)
                    if (topology_.place(mesh_.faceVertices[c]) == side->from) {
                        hole.corners.push_back(c);
                        break;
                    }
            sides += loop.size();
            std::vector<V3f> rim;
            for (const int c : hole.corners) {
                rim.push_back(mesh_.positions[mesh_.faceVertices[c]]);
                hole.centre += V3d(rim.back()) / static_cast<double>(hole.corners.size());
            }
            hole.triangles = capHole(rim, [&](int a, int b) {
                return edges_.count(edgeKey(topology_.place(mesh_.faceVertices[hole.corners[a]]),
                                            topology_.place(mesh_.faceVertices[hole.corners[b]]))) == 0;
            });
            for (const V3i& t : hole.triangles)
                hole.area += 0.5 * (V3d(rim[t.y]) - V3d(rim[t.x])).cross(V3d(rim[t.z]) - V3d(rim[t.x])).length();
            for (std::size_t i = 0; i < rim.size(); ++i)
                hole.length += (V3d(rim[i]) - V3d(rim[(i + 1) % rim.size()])).length();
            shell.holes.push_back(std::move(hole));
        }
        shell.closable = sides == topology_.openSides(s).size();
    }

    void noteFaults() {
        const auto note = [&](MeshReport::Fault& fault, std::size_t count, const std::string& where) {
            fault.count = count;
            fault.where = where;
        };
        for (std::size_t f = 0; f < mesh_.faceCount(); ++f) {
            const V3f area = polygonAreaVector(mesh_.positions, mesh_.faceVertices.data() + starts_[f],
                                               starts_[f + 1] - starts_[f]);
            if (area.length2() == 0.f && report_.flatFaces.count++ == 0)
                report_.flatFaces.where = faceText(static_cast<int>(f));
            if (topology_.shellOf(f) >= 0 && topology_.turned(f) && report_.turnedFaces.count++ == 0)
                report_.turnedFaces.where = faceText(static_cast<int>(f));
            if (topology_.shellOf(f) < 0 && report_.copiedFaces.count++ == 0)
                report_.copiedFaces.where = faceText(static_cast<int>(f));
        }
        if (!topology_.crowdedEdges().empty())
            note(report_.crowdedEdges, topology_.crowdedEdges().size(), edgeText(topology_.crowdedEdges()[0]));
        if (!topology_.oneSidedEdges().empty())
            note(report_.oneSidedEdges, topology_.oneSidedEdges().size(), edgeText(topology_.oneSidedEdges()[0]));
        if (!topology_.pinchedPlaces().empty()) {
            const int v = topology_.pinchedPlaces()[0];
            note(report_.pinchedVertices, topology_.pinchedPlaces().size(),
                 fmt::format("vertex {}, at {}", v + 1, textOf(mesh_.positions[v])));
        }
        if (report_.turnedFaces.count > 0)
            change(fmt::format("faces wound against their neighbours turned round: {} ({})", report_.turnedFaces.count,
                               report_.turnedFaces.where));
        if (report_.copiedFaces.count > 0)
            change(fmt::format("copies of other faces dropped: {} ({})", report_.copiedFaces.count,
                               report_.copiedFaces.where));
        if (report_.oneSidedEdges.count > 0)
            report_.warnings.push_back(fmt::format(
                "a surface has no two sides (a Möbius strip): its front changes to its back at {} edges ({})",
                report_.oneSidedEdges.count, report_.oneSidedEdges.where));
        if (report_.crowdedEdges.count > 0)
            report_.warnings.push_back(fmt::format("edges of more than two faces: {} ({})", report_.crowdedEdges.count,
                                                   report_.crowdedEdges.where));
        if (report_.flatFaces.count > 0)
            report_.notices.push_back(
                fmt::format("faces without an area: {} ({})", report_.flatFaces.count, report_.flatFaces.where));
    }

    const WindingNumber& everything() {
        if (!everything_) {
            std::vector<V3i> triangles;
            for (const Shell& shell : shells_)
                triangles.insert(triangles.end(), shell.triangles.begin(), shell.triangles.end());
            everything_.emplace(mesh_.positions, triangles);
        }
        return *everything_;
    }

    /// The part of a shell's area behind which the winding number is near a whole number.
    double definedFraction(const Shell& shell) {
        double defined = 0.0, all = 0.0;
        const std::size_t step = std::max<std::size_t>(1, shell.triangles.size() / 256);
        for (std::size_t i = 0; i < shell.triangles.size(); i += step) {
            const V3i& t = shell.triangles[i];
            const V3d a(mesh_.positions[t.x]), b(mesh_.positions[t.y]), c(mesh_.positions[t.z]);
            const V3d cross = (b - a).cross(c - a);
            const double twice = cross.length();
            if (twice <= 0.0)
                continue;
            const double w = everything().at((a + b + c) / 3.0 - cross / twice * (1e-3 * std::sqrt(twice)));
            all += twice;
            if (w > 0.7 && std::abs(w - std::round(w)) < 0.3)
                defined += twice;
        }
        return all > 0.0 ? defined / all : 0.0;
    }

    /// The area of a shell's holes that lie in the air, over its own.
    double openFraction(const Shell& shell) {
        double open = 0.0;
        for (const Hole& hole : shell.holes)
            for (const V3i& t : hole.triangles) {
                const V3d a = vertex(hole.corners[t.x]), b = vertex(hole.corners[t.y]), c = vertex(hole.corners[t.z]);
                if (hole.triangles.size() > 64 || everything().at((a + b + c) / 3.0) < 0.75)
                    open += 0.5 * (b - a).cross(c - a).length();
            }
        return open / shell.area;
    }

    /// Which open shells are solids with holes. What one of them closes can make another's inside clear (eyes in their
    /// sockets), so the question is put again until nothing changes.
    void classify() {
        std::vector<double> open(shells_.size(), 1.0), defined(shells_.size(), 0.0);
        const auto isOpen = [&](std::size_t s) { return !shells_[s].closed; };
        const bool judge = mode_ == RepairMode::automatic || mode_ == RepairMode::none;
        std::vector<char> settled(shells_.size(), 0);
        for (std::size_t s = 0; s < shells_.size(); ++s)
            settled[s] = !isOpen(s) || !shells_[s].closable || isFlat(shells_[s]);
        for (std::size_t s = 0; s < shells_.size(); ++s) {
            const auto& holes = shells_[s].holes;
            const bool onlyCracks = std::all_of(holes.begin(), holes.end(), isCrack);
            if (!settled[s] && (onlyCracks || mode_ == RepairMode::holes)) {
                closeHoles(shells_[s]);
                settled[s] = 1;
            }
        }
        for (bool again = judge; again;) {
            again = false;
            everything_.reset();
            std::vector<std::size_t> clear;
            for (std::size_t s = 0; s < shells_.size(); ++s) {
                if (settled[s])
                    continue;
                open[s] = openFraction(shells_[s]);
                defined[s] = definedFraction(shells_[s]);
                if (open[s] == 0.0 || (open[s] <= mostOpen && defined[s] >= leastDefined))
                    clear.push_back(s);
            }
            for (const std::size_t s : clear) {
                closeHoles(shells_[s]);
                settled[s] = 1;
                again = true;
            }
        }
        for (std::size_t s = 0; s < shells_.size(); ++s) {
            describeHoles(static_cast<int>(s));
            if (!isOpen(s))
                continue;
            const std::string which = fmt::format("the shell of {} faces with {} open edges ({})",
                                                  shells_[s].faces.size(),
                                                  topology_.openSides(static_cast<int>(s)).size(),
                                                  faceText(shells_[s].faces[0]));
            if (mode_ == RepairMode::holes)
                report_.warnings.push_back(which + " has no inside that closing its holes would give; it stays a sheet");
            else if (judge && !settled[s] && open[s] < 0.6 && defined[s] >= 0.5)
                report_.warnings.push_back(fmt::format("it is not clear whether {} is a sheet or a solid: its holes make "
                                                       "up {:.0f} % of it; it stays a sheet, --repair holes closes it",
                                                       which, 100.0 * open[s]));
        }
    }

    static bool isCrack(const Hole& hole) { return hole.area <= 1e-7 * hole.length * hole.length; }

    void closeHoles(Shell& shell) {
        shell.closed = true;
        for (const Hole& hole : shell.holes)
            for (const V3i& t : hole.triangles) {
                V3i triangle(mesh_.faceVertices[hole.corners[t.x]], mesh_.faceVertices[hole.corners[t.y]],
                             mesh_.faceVertices[hole.corners[t.z]]);
                if (shell.volume < 0.0)
                    std::swap(triangle.y, triangle.z);
                shell.triangles.push_back(triangle);
            }
    }

    void describeHoles(int s) {
        const Shell& shell = shells_[s];
        std::size_t cracks = 0;
        for (const Hole& hole : shell.holes) {
            MeshReport::Hole& found = report_.holes.emplace_back();
            found.shell = s;
            found.edges = hole.corners.size();
            found.area = hole.area;
            found.centre = V3f(hole.centre);
            found.vertex = mesh_.faceVertices[hole.corners[0]];
            found.crack = isCrack(hole);
            found.closed = shell.closed;
            if (!shell.closed)
                continue;
            if (found.crack && cracks++ == 0)
                change(fmt::format("cracks were closed (vertices that lie on the edges of other faces; the first is vertex "
                                   "{}, at {})",
                                   found.vertex + 1, textOf(mesh_.positions[found.vertex])));
            // A scan can have hundreds: the report has them all.
            if (!found.crack && ++closedHoles_ == mostTold + 1)
                change("more holes were closed: all are in the report");
            if (!found.crack && closedHoles_ <= mostTold)
                change(fmt::format("a hole of {} edges was closed: {:.3g} across, at {} (vertex {})", found.edges,
                                   2.0 * std::sqrt(hole.area / 3.14159265), textOf(found.centre), found.vertex + 1));
        }
    }

    /// Closed shells around nothing, such as a wall between two rooms of a solid: metal (or air) on both sides.
    void dropFlatShells() {
        for (Shell& shell : shells_)
            if (shell.closed && isFlat(shell)) {
                shell.drop = true;
                change(fmt::format("a shell of {} faces without a volume was dropped ({})", shell.faces.size(),
                                   faceText(shell.faces[0])));
            }
        if (std::all_of(shells_.begin(), shells_.end(), [](const Shell& shell) { return shell.drop; }))
            throw ModelError(mesh_.name, "it has no inside, and no sheet either: its faces lie on top of each other");
    }

    void nest() {
        std::vector<int> order;
        for (std::size_t s = 0; s < shells_.size(); ++s)
            if (shells_[s].closed && !shells_[s].drop)
                order.push_back(static_cast<int>(s));
        std::sort(order.begin(), order.end(), [&](int a, int b) {
            const double va = std::abs(shells_[a].volume), vb = std::abs(shells_[b].volume);
            return va > vb || (va == vb && a < b);
        });
        std::vector<std::optional<WindingNumber>> winding(shells_.size());
        for (std::size_t i = 0; i < order.size(); ++i) {
            Shell& shell = shells_[order[i]];
            // Containers are larger: from the smallest of them on.
            for (std::size_t j = i; j-- > 0 && shell.parent < 0;) {
                const Shell& other = shells_[order[j]];
                bool within = true;
                for (int axis = 0; axis < 3; ++axis)
                    within = within && other.low[axis] <= shell.low[axis] && other.high[axis] >= shell.high[axis];
                if (!within)
                    continue;
                if (!winding[order[j]])
                    winding[order[j]].emplace(mesh_.positions, other.triangles);
                const std::size_t step = std::max<std::size_t>(1, shell.triangles.size() / 16);
                for (std::size_t t = 0; t < shell.triangles.size() && within; t += step)
                    within = winding[order[j]]->at(V3d(mesh_.positions[shell.triangles[t].x])) > 0.75;
                if (within)
                    shell.parent = order[j];
            }
        }
        for (const int s : order) {
            Shell& shell = shells_[s];
            const bool fileOutward = shell.volume > 0.0;
            if (shell.parent >= 0 && shells_[shell.parent].outward) {
                const bool sameWay = fileOutward == (shells_[shell.parent].volume > 0.0);
                shell.outward = sameWay;
            }
            if (shell.parent < 0 && !fileOutward)
                change(fmt::format("a shell of {} faces was turned inside out and was turned over ({})",
                                   shell.faces.size(), faceText(shell.faces[0])));
        }
    }

    /// Windings around a point just outside a shell.
    int around(const Shell& shell) const {
        int sum = 0;
        for (int p = shell.parent; p >= 0; p = shells_[p].parent)
            sum += shells_[p].outward ? 1 : -1;
        return sum;
    }

    void describeShells() {
        std::size_t hidden = 0, cavities = 0;
        for (std::size_t s = 0; s < shells_.size(); ++s) {
            const Shell& shell = shells_[s];
            if (shell.drop)
                continue;
            MeshReport::Shell& out = report_.shells.emplace_back();
            out.faces = shell.faces.size();
            out.area = shell.area;
            out.openEdges = topology_.openSides(static_cast<int>(s)).size();
            out.firstFace = shell.faces[0];
            out.place = mesh_.positions[mesh_.faceVertices[starts_[shell.faces[0]]]];
            for (const int f : shell.faces)
                out.turnedFaces += topology_.turned(f);
            if (!shell.closed) {
                out.kind = Kind::sheet;
                continue;
            }
            out.volume = std::abs(shell.volume);
            out.turnedOver = shell.outward != (shell.volume > 0.0);
            const int outside = around(shell);
            if (shell.outward)
                out.kind = outside >= 1 ? Kind::hidden : Kind::solid;
            else
                out.kind = outside >= 2 ? Kind::hidden : Kind::cavity;
            hidden += out.kind == Kind::hidden;
            cavities += out.kind == Kind::cavity;
            if (out.kind == Kind::hidden && hidden == 1)
                report_.notices.push_back(fmt::format("a shell of {} faces lies in the metal of another and is hidden ({})",
                                                      out.faces, faceText(out.firstFace)));
            if (out.kind == Kind::cavity && cavities == 1)
                report_.notices.push_back(fmt::format("a shell of {} faces is a cavity in another, closed to the air ({})",
                                                      out.faces, faceText(out.firstFace)));
        }
    }

    void apply() {
        if (mode_ == RepairMode::none && report_.repaired)
            throw ModelError(mesh_.name, fmt::format("would need repair: {}", fmt::join(report_.warnings, "; ")),
                             "repair the model, or let it be done: --repair auto, holes or sheet");
        if (!report_.repaired)
            return;
        std::vector<char> keep(mesh_.faceCount(), 1), reverse(mesh_.faceCount(), 0);
        for (std::size_t f = 0; f < keep.size(); ++f) {
            const int s = topology_.shellOf(f);
            if (s < 0 || shells_[s].drop) {
                keep[f] = 0;
                continue;
            }
            const bool over = shells_[s].closed && shells_[s].outward != (shells_[s].volume > 0.0);
            reverse[f] = topology_.turned(f) != over;
        }
        Mesh old = std::move(mesh_);
        mesh_ = Mesh();
        mesh_.name = old.name;
        mesh_.positions = std::move(old.positions);
        mesh_.uvs = std::move(old.uvs);
        mesh_.vertexAttributes = std::move(old.vertexAttributes);
        mesh_.creases = std::move(old.creases);
        mesh_.corners = std::move(old.corners);
        const bool hasUvs = old.hasUvs();
        for (std::size_t f = 0; f < keep.size(); ++f) {
            if (!keep[f])
                continue;
            const int size = old.faceSizes[f];
            mesh_.faceSizes.push_back(size);
            for (int i = 0; i < size; ++i) {
                const int corner = starts_[f] + (reverse[f] ? (size - i) % size : i);
                mesh_.faceVertices.push_back(old.faceVertices[corner]);
                if (hasUvs)
                    mesh_.faceUvs.push_back(old.faceUvs[corner]);
            }
        }
        for (const Shell& shell : shells_) {
            if (!shell.closed || shell.drop)
                continue;
            const bool over = shell.outward != (shell.volume > 0.0);
            for (const Hole& hole : shell.holes)
                for (const V3i& t : hole.triangles) {
                    mesh_.faceSizes.push_back(3);
                    for (const int i : {t.x, over ? t.z : t.y, over ? t.y : t.z}) {
                        mesh_.faceVertices.push_back(old.faceVertices[hole.corners[i]]);
                        if (hasUvs)
                            mesh_.faceUvs.push_back(old.faceUvs[hole.corners[0]]);
                    }
                }
        }
    }

    Mesh& mesh_;
    RepairMode mode_;
    std::vector<int> starts_;
    MeshTopology topology_;
    std::vector<Shell> shells_;
    std::unordered_set<std::uint64_t> edges_;
    std::optional<WindingNumber> everything_;
    std::size_t closedHoles_ = 0;
    MeshReport report_;
};

} // namespace

MeshReport repairMesh(Mesh& mesh, RepairMode mode) {
    Mesh repaired = mesh;
    std::vector<std::string> changes;
    if (joinVertices(repaired))
        changes.push_back("vertices at one place were joined");
    {
        const std::vector<int> starts = startsOf(repaired);
        const MeshTopology topology(repaired.positions, starts, repaired.faceVertices.data());
        const std::vector<int> backs = backsOfDoubleSheets(repaired, starts, topology);
        if (!backs.empty()) {
            changes.push_back(fmt::format("a sheet that is there twice, once for each side, keeps its front only: {} "
                                          "faces dropped (face {}, at {})",
                                          backs.size(), backs[0] + 1,
                                          textOf(repaired.positions[repaired.faceVertices[starts[backs[0]]]])));
            removeFaces(repaired, backs);
        }
    }
    MeshReport report = Repair(repaired, mode).run(changes);
    mesh = std::move(repaired);
    return report;
}

} // namespace patina
