#include "surface/mesh_topology.h"

#include "surface/triangulate.h"
#include "surface/weld.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace patina {

using Imath::V3d;
using Imath::V3f;

namespace {

/// Sets that are joined; the smallest member stands for the set.
class Sets {
  public:
    explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
    int find(int i) {
        while (parent_[i] != i)
            i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(int a, int b) {
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

  private:
    std::vector<int> parent_;
};

} // namespace

MeshTopology::MeshTopology(const std::vector<V3f>& positions, const std::vector<int>& starts, const int* corners)
    : positions_(positions), starts_(starts), corners_(corners), place_(weldedIndices(positions)),
      shellOf_(starts.size() - 1, 0), turned_(starts.size() - 1, 0), area_(starts.size() - 1) {
    for (std::size_t f = 0; f < area_.size(); ++f)
        area_[f] = 0.5 * V3d(polygonAreaVector(positions, corners + starts[f], starts[f + 1] - starts[f])).length();
    findCopies();
    collectEdges();
    joinAcrossPairs();
    joinAcrossCrowds();
    collectOpenSides();
    findPinches();
}

V3d MeshTopology::normalOf(int face) const {
    return V3d(polygonAreaVector(positions_, corners_ + starts_[face], starts_[face + 1] - starts_[face])).normalized();
}

MeshTopology::Side MeshTopology::sideOf(const HalfEdge& edge) const {
    const bool up = edge.up != (turned_[edge.face] != 0);
    return {edge.face, up ? edge.low : edge.high, up ? edge.high : edge.low};
}

void MeshTopology::findCopies() {
    // Faces with the same sum of mixed corner numbers are looked at closely.
    const auto mix = [](std::uint64_t v) {
        v = (v + 0x9e3779b97f4a7c15ull) * 0xbf58476d1ce4e5b9ull;
        v = (v ^ (v >> 27)) * 0x94d049bb133111ebull;
        return v ^ (v >> 31);
    };
    std::vector<std::pair<std::uint64_t, int>> keys(shellOf_.size());
    for (std::size_t f = 0; f < keys.size(); ++f) {
        keys[f] = {0, static_cast<int>(f)};
        for (int c = starts_[f]; c < starts_[f + 1]; ++c)
            keys[f].first += mix(static_cast<std::uint64_t>(place_[corners_[c]]));
    }
    std::sort(keys.begin(), keys.end());
    const auto placesOf = [&](int f) {
        std::vector<int> places;
        for (int c = starts_[f]; c < starts_[f + 1]; ++c)
            places.push_back(place_[corners_[c]]);
        return places;
    };
    for (std::size_t i = 1; i < keys.size(); ++i) {
        if (keys[i].first != keys[i - 1].first)
            continue;
        std::size_t first = i - 1;
        while (first > 0 && keys[first - 1].first == keys[i].first)
            --first;
        std::vector<int> a = placesOf(keys[i].second);
        for (std::size_t j = first; j < i; ++j) {
            std::vector<int> b = placesOf(keys[j].second);
            if (a.size() != b.size())
                continue;
            const auto rotated = [](std::vector<int> list) {
                std::rotate(list.begin(), std::min_element(list.begin(), list.end()), list.end());
                return list;
            };
            const std::vector<int> forward = rotated(a);
            const std::vector<int> backward = rotated({a.rbegin(), a.rend()});
            b = rotated(b);
            if (b != forward && b != backward)
                continue;
            copies_.push_back({keys[i].second, keys[j].second, b != forward});
            if (b == forward) {
                shellOf_[keys[i].second] = -1;
                break;
            }
        }
    }
    std::sort(copies_.begin(), copies_.end(),
              [](const Copy& a, const Copy& b) { return std::pair(a.face, a.of) < std::pair(b.face, b.of); });
}

void MeshTopology::collectEdges() {
    edges_.reserve(starts_.back());
    for (std::size_t f = 0; f < shellOf_.size(); ++f) {
        const int size = starts_[f + 1] - starts_[f];
        for (int c = 0; c < size && shellOf_[f] >= 0; ++c) {
            const int a = place_[corners_[starts_[f] + c]], b = place_[corners_[starts_[f] + (c + 1) % size]];
            if (a != b)
                edges_.push_back({std::min(a, b), std::max(a, b), static_cast<int>(f), c, a < b});
        }
    }
    std::sort(edges_.begin(), edges_.end(), [](const HalfEdge& a, const HalfEdge& b) {
        return std::array{a.low, a.high, a.face, a.corner} < std::array{b.low, b.high, b.face, b.corner};
    });
    for (std::size_t i = 0; i < edges_.size(); ++i)
        if (i == 0 || edges_[i].low != edges_[i - 1].low || edges_[i].high != edges_[i - 1].high)
            groups_.push_back(static_cast<int>(i));
    groups_.push_back(static_cast<int>(edges_.size()));
}

void MeshTopology::joinAcrossPairs() {
    // Neighbours over edges of two faces, and whether their windings disagree.
    struct Neighbour {
        int face, other;
        bool against;
    };
    std::vector<Neighbour> neighbours;
    for (std::size_t g = 0; g + 1 < groups_.size(); ++g)
        if (groups_[g + 1] - groups_[g] == 2) {
            const HalfEdge &a = edges_[groups_[g]], &b = edges_[groups_[g] + 1];
            neighbours.push_back({a.face, b.face, a.up == b.up});
            neighbours.push_back({b.face, a.face, a.up == b.up});
        }
    std::sort(neighbours.begin(), neighbours.end(), [](const Neighbour& a, const Neighbour& b) {
        return std::pair(a.face, a.other) < std::pair(b.face, b.other);
    });
    std::vector<int> first(shellOf_.size() + 1, 0);
    for (const Neighbour& n : neighbours)
        ++first[n.face + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());

    std::vector<char> seen(shellOf_.size(), 0);
    std::vector<int> shell;
    int count = 0;
    for (std::size_t seed = 0; seed < shellOf_.size(); ++seed) {
        if (seen[seed] || shellOf_[seed] < 0)
            continue;
        shell.assign(1, static_cast<int>(seed));
        seen[seed] = 1;
        double turnedArea = 0.0, area = 0.0;
        for (std::size_t next = 0; next < shell.size(); ++next) {
            const int f = shell[next];
            shellOf_[f] = count;
            area += area_[f];
            turnedArea += turned_[f] ? area_[f] : 0.0;
            for (int i = first[f]; i < first[f + 1]; ++i) {
                const int other = neighbours[i].other;
                if (seen[other])
                    continue;
                seen[other] = 1;
                turned_[other] = turned_[f] != static_cast<char>(neighbours[i].against);
                shell.push_back(other);
            }
        }
        if (turnedArea > 0.5 * area)
            for (const int f : shell)
                turned_[f] = !turned_[f];
        ++count;
    }
    open_.resize(count);
    for (std::size_t g = 0; g + 1 < groups_.size(); ++g)
        if (groups_[g + 1] - groups_[g] == 2) {
            const Side a = sideOf(edges_[groups_[g]]), b = sideOf(edges_[groups_[g] + 1]);
            if (a.from == b.from)
                oneSided_.push_back(a);
        }
}

void MeshTopology::joinAcrossCrowds() {
    Sets shells(open_.size());
    struct Around {
        double angle;
        Side side;
        bool up;
        int balance; ///< of its shell at this edge
    };
    std::vector<Around> ring;
    for (std::size_t g = 0; g + 1 < groups_.size(); ++g) {
        if (groups_[g + 1] - groups_[g] < 3)
            continue;
        crowded_.push_back(sideOf(edges_[groups_[g]]));
        ring.clear();
        const V3d low(positions_[edges_[groups_[g]].low]), high(positions_[edges_[groups_[g]].high]);
        const V3d axis = (high - low).normalized();
        const V3d helper = std::abs(axis.x) < 0.6 ? V3d(1, 0, 0) : V3d(0, 1, 0);
        const V3d right = axis.cross(helper).normalized(), ahead = axis.cross(right);
        std::map<int, int> balance;
        for (int i = groups_[g]; i < groups_[g + 1]; ++i) {
            const Side side = sideOf(edges_[i]);
            const bool up = side.from == edges_[i].low;
            // The face lies to the left of its side: along normal × side.
            const V3d into = normalOf(side.face).cross(edges_[i].up ? axis : -axis);
            ring.push_back({std::atan2(into.dot(ahead), into.dot(right)), side, up, 0});
            balance[shellOf_[side.face]] += up ? 1 : -1;
        }
        // Faces that their own shell already balances need no partner.
        ring.erase(std::remove_if(ring.begin(), ring.end(),
                                  [&](const Around& a) { return balance[shellOf_[a.side.face]] == 0; }),
                   ring.end());
        std::sort(ring.begin(), ring.end(), [](const Around& a, const Around& b) {
            return std::pair(a.angle, a.side.face) < std::pair(b.angle, b.side.face);
        });
        // A face going up has its air at growing angles: with the next one, going down, it faces the same air.
        std::vector<char> taken(ring.size(), 0);
        for (const bool acrossAir : {true, false})
            for (std::size_t i = 0; i < ring.size() && ring.size() > 1; ++i) {
                std::size_t j = (i + 1) % ring.size();
                while (j != i && taken[j])
                    j = (j + 1) % ring.size();
                if (taken[i] || j == i || ring[i].up != acrossAir || ring[j].up == acrossAir)
                    continue;
                taken[i] = taken[j] = 1;
                shells.join(shellOf_[ring[i].side.face], shellOf_[ring[j].side.face]);
            }
    }
    std::vector<int> number(open_.size(), -1);
    int count = 0;
    for (int& shell : shellOf_)
        if (shell >= 0) {
            const int root = shells.find(shell);
            if (number[root] < 0)
                number[root] = count++;
            shell = number[root];
        }
    open_.resize(count);
}

void MeshTopology::collectOpenSides() {
    std::map<int, int> balance;
    for (std::size_t g = 0; g + 1 < groups_.size(); ++g) {
        const int begin = groups_[g], end = groups_[g + 1];
        if (end - begin == 2) {
            // The usual case, quickly.
            const Side a = sideOf(edges_[begin]), b = sideOf(edges_[begin + 1]);
            if (a.from != b.from)
                continue;
        }
        balance.clear();
        for (int i = begin; i < end; ++i)
            balance[shellOf_[edges_[i].face]] += sideOf(edges_[i]).from == edges_[i].low ? 1 : -1;
        // Where more sides go one way than the other, the last ones have no partner.
        for (int i = end - 1; i >= begin; --i) {
            const Side side = sideOf(edges_[i]);
            int& left = balance[shellOf_[side.face]];
            const int way = side.from == edges_[i].low ? 1 : -1;
            if (left * way > 0) {
                left -= way;
                open_[shellOf_[side.face]].push_back(side);
            }
        }
    }
    for (auto& sides : open_)
        std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
            return std::array{a.face, a.from, a.to} < std::array{b.face, b.from, b.to};
        });
}

std::vector<std::vector<MeshTopology::Side>> MeshTopology::openLoops(int shell) const {
    const std::vector<Side>& sides = open_[shell];
    std::multimap<int, std::size_t> leaving;
    for (std::size_t i = 0; i < sides.size(); ++i)
        leaving.emplace(sides[i].from, i);
    std::vector<char> used(sides.size(), 0);
    std::vector<std::vector<Side>> loops;
    for (std::size_t i = 0; i < sides.size(); ++i) {
        if (used[i])
            continue;
        // Walk until a place is met again; the loop from there on is taken out, and the walk goes on.
        std::vector<Side> path;
        std::map<int, std::size_t> met;
        std::size_t at = i;
        while (true) {
            used[at] = 1;
            met.emplace(sides[at].from, path.size());
            path.push_back(sides[at]);
            const int to = sides[at].to;
            const auto again = met.find(to);
            if (again != met.end()) {
                const std::size_t start = again->second;
                loops.emplace_back(path.begin() + static_cast<std::ptrdiff_t>(start), path.end());
                for (std::size_t k = start; k < path.size(); ++k)
                    met.erase(path[k].from);
                path.resize(start);
            }
            const auto range = leaving.equal_range(to);
            auto next = range.first;
            while (next != range.second && used[next->second])
                ++next;
            if (next == range.second)
                break;
            at = next->second;
        }
        // What is left is no loop (windings disagree there): it stays open.
    }
    return loops;
}

void MeshTopology::findPinches() {
    // Corners of a place are joined where their faces share an edge; a place with two sets is where fans touch.
    Sets corners(starts_.back());
    const auto cornersOf = [&](const HalfEdge& edge) {
        const int size = starts_[edge.face + 1] - starts_[edge.face];
        const int from = starts_[edge.face] + edge.corner, to = starts_[edge.face] + (edge.corner + 1) % size;
        return edge.up ? std::pair(from, to) : std::pair(to, from);
    };
    for (std::size_t g = 0; g + 1 < groups_.size(); ++g)
        for (int i = groups_[g] + 1; i < groups_[g + 1]; ++i) {
            const auto a = cornersOf(edges_[groups_[g]]), b = cornersOf(edges_[i]);
            corners.join(a.first, b.first);
            corners.join(a.second, b.second);
        }
    std::vector<int> fan(place_.size(), -1);
    std::vector<char> pinched(place_.size(), 0);
    for (std::size_t f = 0; f < shellOf_.size(); ++f)
        for (int c = starts_[f]; c < starts_[f + 1] && shellOf_[f] >= 0; ++c) {
            const int place = place_[corners_[c]], root = corners.find(c);
            if (fan[place] < 0)
                fan[place] = root;
            else if (fan[place] != root && !pinched[place]) {
                pinched[place] = 1;
                pinched_.push_back(place);
            }
        }
    std::sort(pinched_.begin(), pinched_.end());
}

} // namespace patina
