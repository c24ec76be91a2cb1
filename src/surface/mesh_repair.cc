#include "surface/mesh_repair.h"

#include "base/errors.h"
#include "surface/face_list.h"
#include "surface/mesh_shells.h"
#include "surface/mesh_topology.h"
#include "surface/triangulate.h"
#include "surface/winding_number.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

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

class Repair {
  public:
    Repair(Mesh& mesh, RepairMode mode)
        : mesh_(mesh), mode_(mode), starts_(faceStarts(mesh)),
          topology_(mesh.positions, starts_, mesh.faceVertices.data()) {}

    /// \param changes  what was done to the mesh before
    MeshReport run(const std::vector<std::string>& changes) {
        for (const std::string& text : changes)
            change(text);
        shells_ = gatherShells(mesh_, starts_, topology_);
        noteFaults();
        classify();
        dropFlatShells();
        nest();
        describeShells();
        apply();
        return std::move(report_);
    }

  private:
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

    void noteFaults() {
        const auto note = [&](MeshReport::Fault& fault, std::size_t count, const std::string& where) {
            fault.count = count;
            fault.where = where;
        };
        for (std::size_t f = 0; f < mesh_.faceCount(); ++f) {
            const V3f area =
                polygonAreaVector(mesh_.positions, mesh_.faceVertices.data() + starts_[f], starts_[f + 1] - starts_[f]);
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

    /// Which open shells are solids with holes. What one of them closes can make another's inside clear (eyes in their
    /// sockets), so the question is put again until nothing changes.
    void classify() {
        std::vector<double> open(shells_.size(), 1.0), defined(shells_.size(), 0.0);
        const auto isOpen = [&](std::size_t s) { return !shells_[s].closed; };
        const bool judge = mode_ == RepairMode::automatic || mode_ == RepairMode::none;
        std::vector<char> settled(shells_.size(), 0);
        for (std::size_t s = 0; s < shells_.size(); ++s)
            settled[s] = !isOpen(s) || !shells_[s].closable || shells_[s].isFlat();
        for (std::size_t s = 0; s < shells_.size(); ++s) {
            const auto& holes = shells_[s].holes;
            const bool onlyCracks =
                std::all_of(holes.begin(), holes.end(), [](const ShellHole& hole) { return hole.isCrack(); });
            if (!settled[s] && (onlyCracks || mode_ == RepairMode::holes)) {
                shells_[s].closeHoles(mesh_);
                settled[s] = 1;
            }
        }
        for (bool again = judge; again;) {
            again = false;
            std::optional<ShellInside> inside;
            std::vector<std::size_t> clear;
            for (std::size_t s = 0; s < shells_.size(); ++s) {
                if (settled[s])
                    continue;
                if (!inside)
                    inside.emplace(mesh_, shells_);
                open[s] = inside->openFraction(shells_[s]);
                defined[s] = inside->definedFraction(shells_[s]);
                if (open[s] == 0.0 || (open[s] <= mostOpen && defined[s] >= leastDefined))
                    clear.push_back(s);
            }
            for (const std::size_t s : clear) {
                shells_[s].closeHoles(mesh_);
                settled[s] = 1;
                again = true;
            }
        }
        for (std::size_t s = 0; s < shells_.size(); ++s) {
            describeHoles(static_cast<int>(s));
            if (!isOpen(s))
                continue;
            const std::string which =
                fmt::format("the shell of {} faces with {} open edges ({})", shells_[s].faces.size(),
                            topology_.openSides(static_cast<int>(s)).size(), faceText(shells_[s].faces[0]));
            if (mode_ == RepairMode::holes)
                report_.warnings.push_back(which +
                                           " has no inside that closing its holes would give; it stays a sheet");
            else if (judge && !settled[s] && open[s] < 0.6 && defined[s] >= 0.5)
                report_.warnings.push_back(
                    fmt::format("it is not clear whether {} is a sheet or a solid: its holes make "
                                "up {:.0f} % of it; it stays a sheet, --repair holes closes it",
                                which, 100.0 * open[s]));
        }
    }

    void describeHoles(int s) {
        const MeshShell& shell = shells_[s];
        std::size_t cracks = 0;
        for (const ShellHole& hole : shell.holes) {
            MeshReport::Hole& found = report_.holes.emplace_back();
            found.shell = s;
            found.edges = hole.corners.size();
            found.area = hole.area;
            found.centre = V3f(hole.centre);
            found.vertex = mesh_.faceVertices[hole.corners[0]];
            found.crack = hole.isCrack();
            found.closed = shell.closed;
            if (!shell.closed)
                continue;
            if (found.crack && cracks++ == 0)
                change(fmt::format(
                    "cracks were closed (vertices that lie on the edges of other faces; the first is vertex "
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
        for (MeshShell& shell : shells_)
            if (shell.closed && shell.isFlat()) {
                shell.drop = true;
                change(fmt::format("a shell of {} faces without a volume was dropped ({})", shell.faces.size(),
                                   faceText(shell.faces[0])));
            }
        if (std::all_of(shells_.begin(), shells_.end(), [](const MeshShell& shell) { return shell.drop; }))
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
            MeshShell& shell = shells_[order[i]];
            // Containers are larger: from the smallest of them on.
            for (std::size_t j = i; j-- > 0 && shell.parent < 0;) {
                const MeshShell& other = shells_[order[j]];
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
            MeshShell& shell = shells_[s];
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
    int around(const MeshShell& shell) const {
        int sum = 0;
        for (int p = shell.parent; p >= 0; p = shells_[p].parent)
            sum += shells_[p].outward ? 1 : -1;
        return sum;
    }

    void describeShells() {
        std::size_t hidden = 0, cavities = 0;
        for (std::size_t s = 0; s < shells_.size(); ++s) {
            const MeshShell& shell = shells_[s];
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
                report_.notices.push_back(
                    fmt::format("a shell of {} faces lies in the metal of another and is hidden ({})", out.faces,
                                faceText(out.firstFace)));
            if (out.kind == Kind::cavity && cavities == 1)
                report_.notices.push_back(
                    fmt::format("a shell of {} faces is a cavity in another, closed to the air ({})", out.faces,
                                faceText(out.firstFace)));
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
        for (const MeshShell& shell : shells_) {
            if (!shell.closed || shell.drop)
                continue;
            const bool over = shell.outward != (shell.volume > 0.0);
            for (const ShellHole& hole : shell.holes)
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
    std::vector<MeshShell> shells_;
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
        const std::vector<int> starts = faceStarts(repaired);
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
