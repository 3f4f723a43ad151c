"""Kernels of :mod:`wavelet_core.partition.outline`: which vertices an outline can do without."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._jit import inlined, njit

# what becomes of the outline where a vertex goes: it may not go; it runs straight through; the new
# edge cuts off what lies outside; the new edge takes in what lies beside
STAYS = 0
STRAIGHT = 1
CUTS = 2
FILLS = 3
# an outline vertex is collinear with its outline neighbours below this part of their distance: some
# 1e3 times what rounding leaves of coordinates of 1e7 times a cell (a UTM northing)
COLLINEAR_TOLERANCE = 1e-9
# new faces thinner than this part of their longest edge squared are refused; it is above what
# rounding makes of a flat face in coordinates of 1e7 times its size
FLATNESS_TOLERANCE = 1e-9


class Outline(NamedTuple):
    """Outlines of the input, holes included, and what they may lose.

    squared_tolerance : float, of the distance of an input vertex of the outline from its new edge
    x, y : (n_input,) float64, plan coordinates about the local origin
    after, before : (n_input,) int32, the next vertex along the outline; -1 where there is none
    ids : (n,) int32, input ids of the slots
    lives : (n_input,) bool, what has not gone yet
    cells : (5,) float64, x and y of the corner, size, columns and rows of the grid of cells
    cell_indptr, cell_members : int64, int32; the vertices, by input id, that no face may take in
    """

    squared_tolerance: float
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    after: NDArray[np.int32]
    before: NDArray[np.int32]
    ids: NDArray[np.int32]
    lives: NDArray[np.bool_]
    cells: NDArray[np.float64]
    cell_indptr: NDArray[np.int64]
    cell_members: NDArray[np.int32]


# The point itself where it lies within the outline edge from q to p; otherwise the nearest place of
# that edge, and which share of the way from p to q it is.
@inlined
def nearest_on_edge(x, y, px, py, qx, qy):
    ex, ey = qx - px, qy - py
    if (px - x) * (qy - y) - (py - y) * (qx - x) <= 0.0:
        return x, y, 0.0
    along = ((x - px) * ex + (y - py) * ey) / (ex * ex + ey * ey)
    along = min(max(along, 0.0), 1.0) + 0.0  # no -0.0
    return px + along * ex, py + along * ey, along


# Does the outline run straight through the origin, from p to q?
@inlined
def is_straight(px, py, qx, qy):
    dx, dy = qx - px, qy - py
    return (
        abs(px * qy - py * qx) <= COLLINEAR_TOLERANCE * (dx * dx + dy * dy)
        and px * qx + py * qy < 0.0
    )


# Does a new edge from p to q cut the origin off?
@inlined
def cuts_off(px, py, qx, qy, squared_tolerance):
    return squared_tolerance > 0.0 and px * qy - py * qx > 0.0 and not is_straight(px, py, qx, qy)


# What becomes of the outline where its vertex v goes, and where CUTS the share of the new edge at
# which v is then judged. ring (size,) int32 and ring_x, ring_y (size,), from v, as of walk_ring.
@inlined
def outline_rule(v, size, ring, ring_x, ring_y, outline):
    px, py, qx, qy = ring_x[0], ring_y[0], ring_x[size - 1], ring_y[size - 1]
    runs_straight = is_straight(px, py, qx, qy)
    if outline.squared_tolerance <= 0.0:
        return (STRAIGHT if runs_straight else STAYS), 0.0
    if not keeps_tolerance(
        outline.ids[v], outline.ids[ring[0]], outline.ids[ring[size - 1]], outline
    ):
        return STAYS, 0.0
    if runs_straight:
        return STRAIGHT, 0.0
    if px * qy - py * qx > 0.0:
        return CUTS, nearest_on_edge(0.0, 0.0, px, py, qx, qy)[2]
    if is_clear(outline.ids[v], outline.ids[ring[0]], outline.ids[ring[size - 1]], outline):
        return FILLS, 0.0
    return STAYS, 0.0


# Do all outline vertices of the input between p and q, with v among them, lie near the edge p q?
@njit
def keeps_tolerance(v, p, q, outline):
    x, y = outline.x, outline.y
    ex, ey = x[q] - x[p], y[q] - y[p]
    squared_length = ex * ex + ey * ey
    if squared_length <= 0.0:  # v ends a slit: both its outline neighbours are one place
        return False
    for links, end in ((outline.after, p), (outline.before, q)):
        u = v
        while u != end:
            along = ((x[u] - x[p]) * ex + (y[u] - y[p]) * ey) / squared_length
            along = min(max(along, 0.0), 1.0)
            dx, dy = x[p] + along * ex - x[u], y[p] + along * ey - y[u]
            if dx * dx + dy * dy > outline.squared_tolerance:
                return False
            u = links[u]
    return True


# Does no vertex lie in the triangle that the new edge p q takes in, so that nothing is overlaid?
# It is enough to look at vertices: an edge that crosses the new one would have to end inside.
@njit
def is_clear(v, p, q, outline):
    x, y = outline.x, outline.y
    x0, y0, size = outline.cells[0], outline.cells[1], outline.cells[2]
    n_columns, n_rows = int(outline.cells[3]), int(outline.cells[4])
    first_column = max(int((min(x[v], x[p], x[q]) - x0) / size), 0)
    last_column = min(int((max(x[v], x[p], x[q]) - x0) / size), n_columns - 1)
    first_row = max(int((min(y[v], y[p], y[q]) - y0) / size), 0)
    last_row = min(int((max(y[v], y[p], y[q]) - y0) / size), n_rows - 1)
    for row in range(first_row, last_row + 1):
        cell = row * n_columns
        for k in range(
            outline.cell_indptr[cell + first_column], outline.cell_indptr[cell + last_column + 1]
        ):
            u = outline.cell_members[k]
            if u in (v, p, q) or not outline.lives[u]:
                continue
            if (
                is_left_of(x, y, u, p, v)
                and is_left_of(x, y, u, v, q)
                and is_left_of(x, y, u, q, p)
            ) or (
                is_left_of(x, y, u, v, p)
                and is_left_of(x, y, u, q, v)
                and is_left_of(x, y, u, p, q)
            ):
                return False
    return True


# Is u to the left of the line from a to b, or on it?
@inlined
def is_left_of(x, y, u, a, b):
    return (x[b] - x[a]) * (y[u] - y[a]) - (y[b] - y[a]) * (x[u] - x[a]) >= 0.0
