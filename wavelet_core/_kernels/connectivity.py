"""Kernels of :mod:`wavelet_core.mesh.connectivity`."""

import numpy as np

from ._jit import kernel

# kinds of vertex, by the fans of faces around it
INTERIOR = 0
BOUNDARY = 1
PINCH = 2
ISOLATED = 3


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
