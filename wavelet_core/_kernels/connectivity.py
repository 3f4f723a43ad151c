"""Kernels of :mod:`wavelet_core.mesh.connectivity`."""

import numpy as np

from ._jit import kernel, njit

# kinds of vertex, by the fans of faces around it
INTERIOR = 0
BOUNDARY = 1
PINCH = 2
ISOLATED = 3

# faces of a vertex from which its ring is sorted first: comparing each with each would take a
# minute for a hundred thousand, as a damaged file may have
MANY_FACES = 64


# faces (n_faces, 3) int32; indptr (n_vertices + 1,) int64 and star (3 n_faces,) int32, filled
@kernel
def fill_stars(faces, indptr, star):
    for face in range(faces.shape[0]):
        for corner in range(3):
            indptr[faces[face, corner] + 1] += 1
    for vertex in range(indptr.shape[0] - 1):
        indptr[vertex + 1] += indptr[vertex]
    cursor = indptr[:-1].copy()
    for face in range(faces.shape[0]):
        for corner in range(3):
            vertex = faces[face, corner]
            star[cursor[vertex]] = face
            cursor[vertex] += 1


# The ring of v is written at indptr[v] + v and has room for one more entry than v has faces.
# kind (n,) int8; ring (3 n_faces + n,), ring_size (n,), bad_neighbour (n,) int32: all filled
@kernel
def order_rings(start, stop, faces, indptr, star, kind, ring, ring_size, bad_neighbour):
    for vertex in range(start, stop):
        first, last = indptr[vertex], indptr[vertex + 1]
        degree = last - first
        bad_neighbour[vertex] = -1
        ring_size[vertex] = 0
        if degree == 0:
            kind[vertex] = ISOLATED
            continue
        afters = np.empty(degree, dtype=np.int32)
        befores = np.empty(degree, dtype=np.int32)
        for k in range(degree):
            face = star[first + k]
            if faces[face, 0] == vertex:
                afters[k], befores[k] = faces[face, 1], faces[face, 2]
            elif faces[face, 1] == vertex:
                afters[k], befores[k] = faces[face, 2], faces[face, 0]
            else:
                afters[k], befores[k] = faces[face, 0], faces[face, 1]
        if degree > MANY_FACES:
            doubled = doubled_in(afters, befores)
            if doubled >= 0:
                bad_neighbour[vertex] = doubled
                kind[vertex] = PINCH
            else:
                kind[vertex], ring_size[vertex] = order_many(
                    afters, befores, ring[first + vertex : first + vertex + degree + 1]
                )
            continue
        # the face whose edge (vertex, after) has no neighbour opens the fan; twice is a fault
        opening, n_openings = 0, 0
        for k in range(degree):
            has_neighbour = False
            for other in range(degree):
                if befores[other] == afters[k]:
                    has_neighbour = True
                if other < k and (afters[other] == afters[k] or befores[other] == befores[k]):
                    bad_neighbour[vertex] = afters[k] if afters[other] == afters[k] else befores[k]
            if not has_neighbour:
                if n_openings == 0:
                    opening = k
                n_openings += 1
        base = first + vertex
        ring[base] = afters[opening]
        current, n_walked = opening, 1
        while True:
            following = -1
            for other in range(degree):
                if afters[other] == befores[current]:
                    following = other
                    break
            if following == opening or following < 0 or n_walked == degree:
                break
            ring[base + n_walked] = afters[following]
            current = following
            n_walked += 1
        if n_walked < degree or n_openings > 1:
            kind[vertex] = PINCH
        elif n_openings == 1:
            kind[vertex] = BOUNDARY
            ring[base + degree] = befores[current]
            ring_size[vertex] = degree + 1
        else:
            kind[vertex] = INTERIOR
            ring_size[vertex] = degree


@njit
def doubled_in(afters, befores):
    for corners in (afters, befores):
        in_order = np.sort(corners)
        for k in range(1, len(in_order)):
            if in_order[k] == in_order[k - 1]:
                return in_order[k]
    return -1


# ring (degree + 1,) int32: filled as above. Returns the kind and the size of the ring.
@njit
def order_many(afters, befores, ring):
    degree = len(afters)
    by_after = np.argsort(afters)
    in_order, before_in_order = afters[by_after], np.sort(befores)
    opening, n_openings = 0, 0
    for k in range(degree):
        place = np.searchsorted(before_in_order, afters[k])
        if place == degree or before_in_order[place] != afters[k]:
            if n_openings == 0:
                opening = k
            n_openings += 1
    ring[0] = afters[opening]
    current, n_walked = opening, 1
    while True:
        place = np.searchsorted(in_order, befores[current])
        if place == degree or in_order[place] != befores[current]:
            break
        following = by_after[place]
        if following == opening or n_walked == degree:
            break
        ring[n_walked] = afters[following]
        current = following
        n_walked += 1
    if n_walked < degree or n_openings > 1:
        return PINCH, 0
    if n_openings == 1:
        ring[degree] = befores[current]
        return BOUNDARY, degree + 1
    return INTERIOR, degree
