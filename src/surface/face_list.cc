#include "surface/face_list.h"

#include "surface/weld.h"

#include <cstddef>
#include <unordered_map>
#include <utility>

namespace patina {

namespace {

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

} // namespace

std::vector<int> faceStarts(const Mesh& mesh) {
    std::vector<int> starts(1, 0);
    for (const int size : mesh.faceSizes)
        starts.push_back(starts.back() + size);
    return starts;
}

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

} // namespace patina
