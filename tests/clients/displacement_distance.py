"""How far the surface that Cycles displaced lies from the surface in the volume.

    displacement_distance.py VOLUME POINTS PIXELS

Run by Debian's python3, whose python3-openvdb and numpy read grids. Prints one line of JSON: for each surface in the folder
POINTS (displacement_render.py) the rms, the 99.9th percentile and the largest distance, voxels, and the pixels asked.
"""

import json
import pathlib
import sys

import numpy
import pyopenvdb


class LevelSet:
    """Values between the voxels' centres: trilinear, as everyone reads a grid."""

    def __init__(self, file, name):
        grid = pyopenvdb.read(file, name)
        low, high = grid.evalActiveVoxelBoundingBox()
        low = [x - 2 for x in low]
        self.values = numpy.empty([h + 3 - l for l, h in zip(low, high)], numpy.float32)
        grid.copyToArray(self.values, ijk=low)
        self.voxel = grid.transform.voxelSize()[0]
        self.first = numpy.array(grid.transform.indexToWorld(tuple(low)))  # where the array's first voxel lies

    def at(self, points):
        index = (points - self.first) / self.voxel
        cell = numpy.clip(numpy.floor(index).astype(int), 0, numpy.array(self.values.shape) - 2)
        part = index - cell
        total = numpy.zeros(len(points))
        for corner in numpy.ndindex(2, 2, 2):
            weight = numpy.prod(numpy.where(corner, part, 1.0 - part), axis=1)
            total += weight * self.values[tuple((cell + corner).T)]
        return total

    def distance(self, points):
        """Voxels: the value over the slope, to first order the distance also where the slope is not one."""
        slope = numpy.empty(points.shape)
        for axis in range(3):
            step = numpy.zeros(3)
            step[axis] = 0.5 * self.voxel
            slope[:, axis] = (self.at(points + step) - self.at(points - step)) / self.voxel
        return numpy.abs(self.at(points)) / self.voxel / numpy.maximum(numpy.linalg.norm(slope, axis=1), 0.5)


def main():
    volume, folder, pixels = sys.argv[1], pathlib.Path(sys.argv[2]), int(sys.argv[3])
    surface = LevelSet(volume, "surface")
    folds = numpy.fromfile(folder / "fold_mask", numpy.float32)
    size = int(round(len(folds) ** 0.5))
    folds = folds.reshape(size, size)
    figures = {}
    for file in sorted(folder.glob("*.position")):
        turned = numpy.fromfile(file, numpy.float32).reshape(-1, 3).astype(float)
        uv = numpy.fromfile(file.with_suffix(".uv"), numpy.float32).reshape(-1, 2)
        assert len(turned) == pixels * pixels, "a picture is not of the size asked for"
        hit = numpy.any(turned != 0.0, axis=1)
        # Back from Blender's z up to the model's y.
        points = numpy.stack([turned[:, 0], turned[:, 2], -turned[:, 1]], axis=1)[hit]
        texel = numpy.clip((uv[hit] * size).astype(int), 0, size - 1)
        folded = folds[texel[:, 1], texel[:, 0]] > 0.0
        distances = numpy.sort(surface.distance(points[~folded]))
        figures[file.stem] = {"pixels": int(len(distances)), "folded": int(folded.sum()),
                              "rms": float(numpy.sqrt(numpy.mean(distances**2))),
                              "p999": float(distances[int(0.999 * (len(distances) - 1))]),
                              "max": float(distances[-1])}
    print(json.dumps(figures))


main()
