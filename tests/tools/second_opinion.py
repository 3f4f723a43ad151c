"""Vertical errors of a TIN found in another way: slowly, and with nothing of the package.

Every triangle is held against all points in its box, in the numbers of the file; a mesh is read by
a parser of its own.
"""

import struct
from pathlib import Path
from typing import NamedTuple

import numpy as np


class Errors(NamedTuple):
    """What was measured.

    rmse, largest : of the points that the surface covers
    n_uncovered : points over no triangle and at no vertex
    """

    rmse: float
    largest: float
    n_uncovered: int


def read_ply(path):
    """Return vertices (n, 3) and faces (m, 3) of a PLY file of x, y, z as doubles."""
    content = Path(path).read_bytes()
    head, _, body = content.partition(b"end_header\n")
    lines = [line.split() for line in head.decode("ascii").splitlines()]
    counts = {line[1]: int(line[2]) for line in lines if line[0] == "element"}
    n_doubles = sum(line[:2] == ["property", "double"] for line in lines)
    n, m = counts["vertex"], counts["face"]
    vertices = np.frombuffer(body, "<f8", n * n_doubles).reshape(n, n_doubles)[:, :3]
    faces = np.empty((m, 3), dtype=np.int64)
    at = 8 * n * n_doubles
    for k in range(m):
        count, *faces[k] = struct.unpack_from("<B3i", body, at)
        assert count == 3
        at += 13
    return vertices, faces


def errors_of(vertices, faces, points):
    """Return the vertical distance of each point from the surface; NaN where there is none."""
    origin = vertices[:, :2].mean(axis=0)
    plan, at = vertices[:, :2] - origin, points[:, :2] - origin
    errors = np.full(len(points), np.nan)
    depth = np.full(len(points), -np.inf)  # how far inside its triangle a point is
    order = np.argsort(at[:, 0], kind="stable")
    sorted_x = at[order, 0]
    for a, b, c in faces:
        low, high = plan[[a, b, c]].min(axis=0), plan[[a, b, c]].max(axis=0)
        slack = 1e-9 * (1.0 + float(np.abs(high - low).max()))
        near = order[
            np.searchsorted(sorted_x, low[0] - slack) : np.searchsorted(sorted_x, high[0] + slack)
        ]
        near = near[(at[near, 1] >= low[1] - slack) & (at[near, 1] <= high[1] + slack)]
        if not len(near):
            continue
        edges = np.array([plan[b] - plan[a], plan[c] - plan[a]]).T
        area = edges[0, 0] * edges[1, 1] - edges[0, 1] * edges[1, 0]
        if area == 0:
            continue
        away = (at[near] - plan[a]).T
        of_b = (away[0] * edges[1, 1] - away[1] * edges[0, 1]) / area
        of_c = (edges[0, 0] * away[1] - edges[1, 0] * away[0]) / area
        inside = np.minimum(np.minimum(of_b, of_c), 1.0 - of_b - of_c)
        better = (inside > -1e-7) & (inside > depth[near])
        taken = near[better]
        z = vertices[a, 2] + of_b * (vertices[b, 2] - vertices[a, 2])
        z += of_c * (vertices[c, 2] - vertices[a, 2])
        errors[taken] = points[taken, 2] - z[better]
        depth[taken] = inside[better]
    is_lone = np.ones(len(vertices), dtype=bool)
    is_lone[np.unique(faces)] = False
    for k in np.flatnonzero(is_lone):
        there = np.isnan(errors) & (np.abs(at - plan[k]).max(axis=1) <= 1e-9)
        errors[there] = points[there, 2] - vertices[k, 2]
    return errors


def second_opinion(vertices, faces, points):
    """Return the errors in figures."""
    errors = errors_of(vertices, faces, points)
    known = errors[~np.isnan(errors)]
    if not len(known):
        return Errors(0.0, 0.0, len(errors))
    return Errors(
        float(np.sqrt(np.mean(known**2))), float(np.abs(known).max()), len(errors) - len(known)
    )
