"""Kernels of :mod:`wavelet_core.partition.orderings`: the greedy labelling of Algorithm 2."""

import numpy as np

from ._jit import kernel
from .collapse import is_legal, is_removable
from .quadric import evaluate

UNMARKED = 0
EVEN = 1
ODD = 2
# squared distances, in normalised units, that are nothing but rounding; without the cut, targets
# whose planes all hold the vertex would be told apart by noise, and not by index
ROUNDING = 1e-14


# order (n_candidates,) int64: vertices by ascending cost; points (n, d) float64;
# plan (n, 2) float64; quadrics (n, size) float64, or (0, 0) to take the nearest target instead;
# mark (n,) int8, odd and target (n,) int32: filled. Returns the number of odd vertices.
@kernel
def label(
    order, max_odd, in_plan, points, plan, faces, indptr, star, ring, ring_size, kind, locked,
    quadrics, mark, odd, target,
):  # fmt: skip
    n = points.shape[0]
    n_faces_of = np.empty(n, dtype=np.int32)
    for v in range(n):
        n_faces_of[v] = indptr[v + 1] - indptr[v]
    made_head = np.full(n, -1, dtype=np.int32)
    made_next = np.empty(ring.shape[0], dtype=np.int32)
    made_end = np.empty(ring.shape[0], dtype=np.int32)
    shape = plan if in_plan else points
    n_made = 0
    n_odd = 0
    for rank in range(order.shape[0]):
        if n_odd == max_odd:
            break
        v = order[rank]
        if mark[v] != UNMARKED:
            continue
        mark[v] = EVEN
        base, size = indptr[v] + v, ring_size[v]
        if not is_removable(v, in_plan, shape, locked, kind, ring, base, size):
            continue
        best, best_error = -1, 0.0
        may_update = False
        for position in range(size):
            neighbour = ring[base + position]
            may_update = may_update or not locked[neighbour]
            if quadrics.shape[0] > 0:
                error = evaluate(quadrics[neighbour], points[v])
                if error < ROUNDING:
                    error = 0.0
            else:
                error = 0.0
                for i in range(points.shape[1]):
                    side = points[neighbour, i] - points[v, i]
                    error += side * side
            if best >= 0 and (
                error > best_error or (error == best_error and neighbour > ring[base + best])
            ):
                continue
            if is_legal(
                v, position, in_plan, shape, faces, indptr, star, ring, base, size, kind,
                n_faces_of, made_head, made_next, made_end,
            ):  # fmt: skip
                best, best_error = position, error
        if best < 0 or not may_update:
            continue
        a = ring[base + best]
        mark[v] = ODD
        odd[n_odd], target[n_odd] = v, a
        n_odd += 1
        is_outline = kind[v] == 1
        lost = 0
        for k in range(size):
            neighbour = ring[base + k]
            mark[neighbour] = EVEN
            if k == best:
                continue
            if is_outline:
                is_next = abs(k - best) == 1
            else:
                is_next = k == (best + 1) % size or k == (best - 1) % size
            if is_next:
                n_faces_of[neighbour] -= 1
                lost += 1
            else:
                made_end[n_made] = neighbour
                made_next[n_made] = made_head[a]
                made_head[a] = n_made
                n_made += 1
        n_faces_of[a] += (size - 1 if is_outline else size) - 2 * lost
    return n_odd
