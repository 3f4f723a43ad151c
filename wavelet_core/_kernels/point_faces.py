"""Kernels of :mod:`wavelet_core.mesh.point_faces`: joined points, and the faces of edges."""

import numpy as np

from ._jit import inlined, kernel

#: How many pieces of work are sorted by insertion; more of them by merging.
FEW = 48
#: What is not asked about.
NOT_ASKED = 255
#: Sums of cotangents that are clear, and those that are rounding.
CLEAR, TIED = 0.05, 1e-9


# found (k, m) int64: of each of points (k,) int32 the m nearest, itself among them, in any order;
# x, y (n,) float64; nearest (n, m - 2) int32, reach (n,) float64, filled: the others by distance,
# then by index, without the last one, and the square of that one's distance
@kernel
def order_nearest(start, stop, points, found, x, y, nearest, reach):
    m = found.shape[1]
    squared, ids = np.empty(m), np.empty(m, np.int64)
    for row in range(start, stop):
        v = points[row]
        for k in range(m):
            u = found[row, k]
            here = (x[u] - x[v]) ** 2 + (y[u] - y[v]) ** 2
            j = k
            while j > 0 and (squared[j - 1] > here or (squared[j - 1] == here and ids[j - 1] > u)):
                squared[j], ids[j] = squared[j - 1], ids[j - 1]
                j -= 1
            squared[j], ids[j] = here, u
        reach[v] = squared[m - 1]
        for k in range(m - 2):
            nearest[v, k] = ids[k + 1]


# classes (n, m) uint8, filled: how clear it is that points are joined to those of nearest (n, m),
# NOT_ASKED where that is not asked of this one of the two: docs/reference/format.md, "The input".
@kernel
def classify_pairs(start, stop, x, y, nearest, reach, classes):
    m = nearest.shape[1]
    offset_x, offset_y, squared = np.empty(m), np.empty(m), np.empty(m)
    crosses, cotangents = np.empty(m), np.empty(m)
    for v in range(start, stop):
        n_known = 0
        for k in range(m):
            u = nearest[v, k]
            offset_x[k], offset_y[k] = x[u] - x[v], y[u] - y[v]
            squared[k] = offset_x[k] ** 2 + offset_y[k] ** 2
            classes[v, k] = NOT_ASKED
            n_known += squared[k] < reach[v]  # they are in the order of their distance
        for k in range(n_known):
            u = nearest[v, k]
            if v < u or squared[k] >= reach[u]:
                classes[v, k] = class_of_pair(
                    k, n_known, m, offset_x, offset_y, squared, crosses, cotangents
                )  # fmt: skip


@inlined
def class_of_pair(k, n_known, m, offset_x, offset_y, squared, crosses, cotangents):
    for c in range(n_known):  # without a branch, so that several are divided at a time
        cross = offset_x[k] * offset_y[c] - offset_y[k] * offset_x[c]
        inner = squared[c] - (offset_x[k] * offset_x[c] + offset_y[k] * offset_y[c])
        size = abs(cross)
        crosses[c] = cross
        cotangents[c] = inner / (size if size > 0.0 else 1.0)
    left, right = np.inf, np.inf
    is_between = False
    for c in range(n_known):
        cross, cotangent = crosses[c], cotangents[c]
        left = min(left, cotangent if cross > 0.0 else np.inf)
        right = min(right, cotangent if cross < 0.0 else np.inf)
        is_between |= (cross == 0.0) & (cotangent < 0.0)
    if is_between:
        return 0
    total = left + right
    if total == np.inf:
        return 1
    if total < -CLEAR:
        return 2
    if total < -TIED:
        return 3
    if total <= TIED:
        return 4
    if total <= CLEAR:
        return 5
    return 7 if k >= m // 2 else 6


# Put `keys` [first, last) in order by insertion, which is stable; order moves along
@inlined
def sort_piece(first, last, keys, order):
    for i in range(first + 1, last):
        key, one = keys[i], order[i]
        j = i
        while j > first and keys[j - 1] > key:
            keys[j], order[j] = keys[j - 1], order[j - 1]
            j -= 1
        keys[j], order[j] = key, one


# pairs (k, 2) int32; indptr (n + 1,) int64 and others (k,) int32, filled: of each point, those with
# a higher index that it is paired with
@kernel
def group_pairs(pairs, indptr, others):
    for k in range(pairs.shape[0]):
        indptr[min(pairs[k, 0], pairs[k, 1]) + 1] += 1
    for v in range(indptr.shape[0] - 1):
        indptr[v + 1] += indptr[v]
    cursor = indptr[:-1].copy()
    for k in range(pairs.shape[0]):
        low, high = min(pairs[k, 0], pairs[k, 1]), max(pairs[k, 0], pairs[k, 1])
        others[cursor[low]] = high
        cursor[low] += 1


# others (k,) int32 sorted within each piece of indptr; is_new (k,) bool, filled: no repetition
@kernel
def sort_groups(start, stop, indptr, others, is_new):
    for v in range(start, stop):
        first, last = indptr[v], indptr[v + 1]
        if last - first > FEW:
            others[first:last] = np.sort(others[first:last])
        else:
            for i in range(first + 1, last):
                key = others[i]
                j = i
                while j > first and others[j - 1] > key:
                    others[j] = others[j - 1]
                    j -= 1
                others[j] = key
        for i in range(first, last):
            is_new[i] = i == first or others[i] != others[i - 1]


# Which pairs that are asked about are edges? indptr (n + 1,) int64, heads (k,) int32: edges by
# their lower ends; classes, nearest (n, m); joined (n, m) uint8, filled; is_asked (k,) bool, set
# for the edges that were asked about
@kernel
def look_up_pairs(start, stop, nearest, classes, indptr, heads, joined, is_asked):
    for v in range(start, stop):
        for k in range(nearest.shape[1]):
            joined[v, k] = 0
            if classes[v, k] == NOT_ASKED:
                continue
            low, high = min(v, nearest[v, k]), max(v, nearest[v, k])
            first, last = indptr[low], indptr[low + 1]
            while last - first > 8:
                middle = (first + last) // 2
                if heads[middle] > high:
                    last = middle
                else:
                    first = middle
            for i in range(first, last):
                if heads[i] == high:
                    joined[v, k] = 1
                    is_asked[i] = True


# edges (k, 2) int32, the lower end first, sorted; indptr (n + 1,) int64, heads, edge_of (2 k,)
# int32, filled: the edges around each point, first those to higher ones; edge_of is twice the edge,
# and one more at its higher end
@kernel
def gather_spokes(edges, indptr, heads, edge_of):
    for k in range(edges.shape[0]):
        indptr[edges[k, 0] + 1] += 1
        indptr[edges[k, 1] + 1] += 1
    for v in range(indptr.shape[0] - 1):
        indptr[v + 1] += indptr[v]
    cursor = indptr[:-1].copy()
    for end in range(2):
        for k in range(edges.shape[0]):
            v = edges[k, end]
            heads[cursor[v]] = edges[k, 1 - end]
            edge_of[cursor[v]] = 2 * k + end
            cursor[v] += 1


# heads and edge_of sorted counter-clockwise around each point; place (2 k,) int32, filled: where
# each end of each edge has come to lie
@kernel
def turn_spokes(start, stop, x, y, indptr, heads, edge_of, place):
    for v in range(start, stop):
        first, last = indptr[v], indptr[v + 1]
        n = last - first
        turn, order = np.empty(n), np.arange(n)
        for i in range(n):
            u = heads[first + i]
            across, up = x[u] - x[v], y[u] - y[v]
            turn[i] = up / (abs(across) + abs(up)) if across != 0.0 or up != 0.0 else 0.0
            if across < 0.0:
                turn[i] = 2.0 - turn[i]
        if n > FEW:
            order = np.argsort(turn, kind="mergesort")
        else:
            sort_piece(0, n, turn, order)
        old_heads, old_edges = heads[first:last].copy(), edge_of[first:last].copy()
        for i in range(n):
            heads[first + i], edge_of[first + i] = old_heads[order[i]], old_edges[order[i]]
            place[edge_of[first + i]] = first + i


# n_triangles (n,) int32, filled: of which each point is the lowest corner; a triangle is one where
# each of its corners lies between two edges that follow each other, less than half a turn apart
@kernel
def count_triangles(start, stop, x, y, indptr, heads, edge_of, place, n_triangles):
    for v in range(start, stop):
        n_triangles[v] = 0
        for i in range(indptr[v], indptr[v + 1]):
            n_triangles[v] += begins_triangle(v, i, x, y, indptr, heads, edge_of, place)


# triangles (m, 3) int32, filled from first (n + 1,) int64 on, in the order of their second corners
@kernel
def fill_triangles(start, stop, x, y, indptr, heads, edge_of, place, first, triangles):
    for v in range(start, stop):
        row = first[v]
        for i in range(indptr[v], indptr[v + 1]):
            if begins_triangle(v, i, x, y, indptr, heads, edge_of, place):
                triangles[row, 0], triangles[row, 1] = v, heads[i]
                triangles[row, 2] = heads[following(v, i, indptr)]
                row += 1
        if row - first[v] > FEW:
            piece = triangles[first[v] : row].copy()
            order = np.argsort(piece[:, 1], kind="mergesort")
            for k in range(len(order)):
                for corner in range(3):
                    triangles[first[v] + k, corner] = piece[order[k], corner]
        else:
            for k in range(first[v] + 1, row):
                b, c = triangles[k, 1], triangles[k, 2]
                j = k
                while j > first[v] and triangles[j - 1, 1] > b:
                    triangles[j, 1], triangles[j, 2] = triangles[j - 1, 1], triangles[j - 1, 2]
                    j -= 1
                triangles[j, 1], triangles[j, 2] = b, c


@inlined
def following(v, i, indptr):
    return i + 1 if i + 1 < indptr[v + 1] else indptr[v]


@inlined
def is_convex(v, b, c, x, y):
    return (x[b] - x[v]) * (y[c] - y[v]) - (y[b] - y[v]) * (x[c] - x[v]) > 0.0


@inlined
def begins_triangle(v, i, x, y, indptr, heads, edge_of, place):
    after = following(v, i, indptr)
    b, c = heads[i], heads[after]
    if b <= v or c <= v or not is_convex(v, b, c, x, y):
        return False
    at_b = place[edge_of[i] ^ 1]  # from b to v; the one before it leads to c
    at_b = at_b - 1 if at_b > indptr[b] else indptr[b + 1] - 1
    at_c = following(c, place[edge_of[after] ^ 1], indptr)  # the one after that to v leads to b
    return (
        heads[at_b] == c
        and heads[at_c] == b
        and is_convex(b, c, v, x, y)
        and is_convex(c, v, b, x, y)
    )
