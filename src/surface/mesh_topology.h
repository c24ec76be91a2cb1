#pragma once
// Which faces join into which shell, whatever the soup.

#include <Imath/ImathVec.h>

#include <vector>

namespace patina {

/// Faces joined over their edges. Vertices at exactly one place count as one. Works on any face list: edges of one,
/// three or more faces, faces twice, faces wound against their neighbours.
///
/// Two faces are of one shell where they alone share an edge, or where they lie next to each other around an edge of
/// more than two and face the same air. Windings are compared across edges of two faces: `turned` says which faces lie
/// against the rest of their shell (the smaller area; of equal ones the later).
class MeshTopology {
  public:
    /// \param starts   first corner of each face, and their total behind the last
    /// \param corners  vertex of each corner
    MeshTopology(const std::vector<Imath::V3f>& positions, const std::vector<int>& starts, const int* corners);

    /// A side of a face, from vertex to vertex as the shell goes (turned faces turned).
    struct Side {
        int face;
        int from, to; ///< places
    };

    int shellCount() const { return static_cast<int>(open_.size()); }
    int shellOf(std::size_t face) const { return shellOf_[face]; } ///< -1: a copy of another face
    bool turned(std::size_t face) const { return turned_[face] != 0; }
    /// The smallest vertex at the same place.
    int place(int vertex) const { return place_[vertex]; }

    /// The sides of a shell that no other of its faces lies against, by face and corner: none of a closed shell.
    const std::vector<Side>& openSides(int shell) const { return open_[shell]; }
    /// The open sides of a shell as loops; each goes round as its faces do.
    std::vector<std::vector<Side>> openLoops(int shell) const;

    /// Edges of two faces at which no winding fits (a Möbius strip has some), as sides of one of them.
    const std::vector<Side>& oneSidedEdges() const { return oneSided_; }
    /// Edges of more than two faces, as sides of the first of them.
    const std::vector<Side>& crowdedEdges() const { return crowded_; }
    /// Places at which faces meet that share no edge there.
    const std::vector<int>& pinchedPlaces() const { return pinched_; }

    struct Copy {
        int face, of;
        bool opposite; ///< wound the other way
    };
    /// Faces with the same corners as an earlier one. Those wound alike are of no shell.
    const std::vector<Copy>& copies() const { return copies_; }

  private:
    struct HalfEdge {
        int low, high, face, corner;
        bool up; ///< from low to high
    };
    void findCopies();
    void collectEdges();
    void joinAcrossPairs();
    void joinAcrossCrowds();
    void collectOpenSides();
    void findPinches();
    Side sideOf(const HalfEdge& edge) const;
    Imath::V3d normalOf(int face) const;

    const std::vector<Imath::V3f>& positions_;
    const std::vector<int>& starts_;
    const int* corners_;
    std::vector<int> place_;
    std::vector<HalfEdge> edges_;
    std::vector<int> groups_; ///< first half-edge of each edge, and their number behind the last
    std::vector<int> shellOf_;
    std::vector<char> turned_;
    std::vector<double> area_;
    std::vector<std::vector<Side>> open_;
    std::vector<Side> oneSided_, crowded_;
    std::vector<int> pinched_;
    std::vector<Copy> copies_;
};

} // namespace patina
