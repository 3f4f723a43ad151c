"""Coarse TINs of LiDAR clouds against thinning and against a mesh simplifier.

usage: python benchmarks/quality/clouds.py CLOUD [CLOUD ...] [--keep 0.25,0.1,0.02]
       [--attribute intensity] [--output clouds.jsonl]

All points are used, whatever their class; of points that share x and y, the lowest. Every method
gets the same points and the same number of vertices:

- ours: `analyse` of the points' TIN with the attribute as a second channel;
- ours, z only: the attribute's weight next to nothing;
- every k-th point of the file, triangulated anew;
- one point a cell of a square grid, the one nearest to the cell's centre, triangulated anew;
- fast-simplification of the same TIN; its vertices take the attribute of the nearest point.

Errors are those of z and of the attribute at every point, linear in the faces, by a point locator
that shares nothing with the package. Needs the extra "bench": pip install -e ".[bench]"
"""

import argparse
import json
from pathlib import Path
from time import perf_counter

import numpy as np
from numba import njit
from scipy.spatial import cKDTree

from wavelet_core import TriangleMesh, analyse
from wavelet_gis.io.las import read_cloud

#: Square cells of the point locator hold about this many points.
POINTS_IN_CELL = 4
FAINT = 1e-6


# -- the methods: (mesh, n_vertices) -> (vertices, faces, attribute) ------------------------------


def ours(mesh, n):
    coarse = analyse(mesh, target_vertices=n).mesh(0)
    return coarse.vertices, coarse.faces, coarse.attributes[:, 0]


def ours_z_only(mesh, n):
    coarse = analyse(mesh, target_vertices=n, attribute_weights=[FAINT]).mesh(0)
    return coarse.vertices, coarse.faces, coarse.attributes[:, 0]


def every_kth(mesh, n):
    kept = np.round(np.linspace(0, mesh.n_vertices - 1, n)).astype(int)
    return _triangulated(mesh, np.unique(kept))


def grid_thinned(mesh, n):
    low, high = _bounds(mesh)
    narrow, wide = 0.0, float(np.hypot(*(high - low)))
    for _ in range(30):  # the cell that leaves n points
        size = (narrow + wide) / 2
        kept = _nearest_to_centres(mesh, low, size)
        narrow, wide = (size, wide) if len(kept) > n else (narrow, size)
    return _triangulated(mesh, kept)


def fast_simplification(mesh, n):
    import fast_simplification

    origin = mesh.vertices.mean(axis=0)
    vertices, faces = fast_simplification.simplify(
        mesh.vertices - origin, mesh.faces.astype(np.int32), target_count=2 * n
    )
    vertices = vertices + origin
    nearest = cKDTree(mesh.vertices[:, :2]).query(vertices[:, :2])[1]
    return vertices, faces, mesh.attributes[nearest, 0]


METHODS = {
    "ours": ours,
    "ours, z only": ours_z_only,
    "fast-simplification": fast_simplification,
    "one point a cell": grid_thinned,
    "every k-th point": every_kth,
}


def _bounds(mesh):
    return mesh.vertices[:, :2].min(axis=0), mesh.vertices[:, :2].max(axis=0)


def _nearest_to_centres(mesh, low, size):
    cell = np.floor((mesh.vertices[:, :2] - low) / size).astype(np.int64)
    distance = np.linalg.norm(mesh.vertices[:, :2] - low - (cell + 0.5) * size, axis=1)
    order = np.lexsort((distance, cell[:, 1], cell[:, 0]))
    is_first = np.ones(len(order), dtype=bool)
    is_first[1:] = (np.diff(cell[order], axis=0) != 0).any(axis=1)
    return np.sort(order[is_first])


def _triangulated(mesh, kept):
    coarse = TriangleMesh.from_points(mesh.vertices[kept], mesh.attributes[kept])
    return coarse.vertices, coarse.faces, coarse.attributes[:, 0]


# -- what came out --------------------------------------------------------------------------------


# Value of each column (n, c) of a TIN at the points (k, 2), sorted into square cells: point ids
# `order` in CSR by `first`. Fills values (k, c) and found (k,) bool; counts flipped faces.
@njit
def lay_faces(plan, columns, faces, points, order, first, low, size, shape, values, found):
    n_flipped = 0
    for f in range(faces.shape[0]):
        a, b, c = plan[faces[f, 0]], plan[faces[f, 1]], plan[faces[f, 2]]
        area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        if area == 0.0:
            continue
        n_flipped += area < 0.0
        left = max(int((min(a[0], b[0], c[0]) - low[0]) / size), 0)
        right = min(int((max(a[0], b[0], c[0]) - low[0]) / size), shape[0] - 1)
        bottom = max(int((min(a[1], b[1], c[1]) - low[1]) / size), 0)
        top = min(int((max(a[1], b[1], c[1]) - low[1]) / size), shape[1] - 1)
        for i in range(left, right + 1):
            for j in range(bottom, top + 1):
                cell = i * shape[1] + j
                for k in range(first[cell], first[cell + 1]):
                    p = order[k]
                    x, y = points[p, 0], points[p, 1]
                    at_a = ((b[0] - x) * (c[1] - y) - (c[0] - x) * (b[1] - y)) / area
                    at_b = ((c[0] - x) * (a[1] - y) - (a[0] - x) * (c[1] - y)) / area
                    at_c = 1.0 - at_a - at_b
                    if min(at_a, at_b, at_c) >= -1e-9:
                        found[p] = True
                        for m in range(columns.shape[1]):
                            values[p, m] = (
                                at_a * columns[faces[f, 0], m]
                                + at_b * columns[faces[f, 1], m]
                                + at_c * columns[faces[f, 2], m]
                            )
    return n_flipped


def judge(mesh, vertices, faces, attribute):
    """Return size, errors and faults of a TIN over the points of a mesh."""
    low, high = _bounds(mesh)
    points = mesh.vertices[:, :2] - low
    size = float(np.sqrt(np.prod(high - low) * POINTS_IN_CELL / len(points)))
    shape = np.floor((high - low) / size).astype(np.int64) + 1
    cell = np.floor(points / size).astype(np.int64) @ [shape[1], 1]
    first = np.concatenate([[0], np.cumsum(np.bincount(cell, minlength=shape.prod()))])
    values, found = np.zeros((len(points), 2)), np.zeros(len(points), bool)
    faces = np.ascontiguousarray(faces, dtype=np.int64)
    n_flipped = lay_faces(
        np.ascontiguousarray(vertices[:, :2] - low, dtype=np.float64),
        np.column_stack([vertices[:, 2], attribute]).astype(np.float64),
        faces, points, np.argsort(cell, kind="stable"), first, np.zeros(2), size, shape,
        values, found,
    )  # fmt: skip
    measured = np.column_stack([mesh.vertices[:, 2], mesh.attributes[:, 0]])
    error = (values - measured)[found]
    return {
        "n_vertices": len(np.unique(faces)),
        "rmse": float(np.sqrt((error[:, 0] ** 2).mean())),
        "max_error": float(np.abs(error[:, 0]).max()),
        "rmse_attribute": float(np.sqrt((error[:, 1] ** 2).mean())),
        "n_uncovered": int((~found).sum()),
        "n_flipped": int(min(n_flipped, len(faces) - n_flipped)),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("clouds", nargs="+")
    numbers = lambda text: [float(part) for part in text.split(",")]  # noqa: E731
    parser.add_argument("--keep", type=numbers, default=[0.25, 0.1, 0.02])
    parser.add_argument("--attribute", default="intensity")
    parser.add_argument("--output", default="clouds.jsonl")
    arguments = parser.parse_args()
    print("| cloud | kept | method | vertices | RMSE z | largest | RMSE attribute | points not "
          "covered | flipped | seconds |\n|---|---|---|---|---|---|---|---|---|---|")  # fmt: skip
    for path in arguments.clouds:
        cloud, _ = read_cloud(path, attributes=[arguments.attribute], carry=False)
        column = cloud.attributes[0].lifted()
        names = (arguments.attribute,)
        mesh = TriangleMesh.from_points(cloud.coordinates(), column[:, None], names)
        for keep in arguments.keep:
            for name, method in METHODS.items():
                began = perf_counter()
                result = method(mesh, int(keep * mesh.n_vertices))
                seconds = perf_counter() - began
                figures = judge(mesh, *result)
                print(
                    f"| {Path(path).name} | {keep:.0%} | {name} | {figures['n_vertices']:,} | "
                    f"{figures['rmse']:.3f} | {figures['max_error']:.2f} | "
                    f"{figures['rmse_attribute']:.2f} | {figures['n_uncovered']:,} | "
                    f"{figures['n_flipped']:,} | {seconds:.1f} |",
                    flush=True,
                )
                line = {"cloud": Path(path).name, "keep": keep, "method": name, "seconds": seconds}
                with open(arguments.output, "a", encoding="utf-8") as stream:
                    stream.write(json.dumps(line | figures) + "\n")


if __name__ == "__main__":
    main()
