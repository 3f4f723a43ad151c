"""Kernels on a half-edge mesh that is collapsed in place.

Half-edge ``h = 3 * face + corner`` runs from the face's corner to the next one; it goes with its
face. A vertex of the outline names, as its outgoing half-edge, the one without a twin, so that a
walk from it counter-clockwise meets its whole fan.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._jit import inlined, kernel

NO_INDEX = -1
# longest one-ring that is looked at; a vertex with more neighbours stays
MAX_RING = 64


class HalfEdges(NamedTuple):
    """Topology of a triangle mesh.

    origin : (3 n_faces,) int32, vertex that each half-edge leaves
    twin : (3 n_faces,) int32, NO_INDEX on the outline
    outgoing : (n_vertices,) int32, a half-edge that leaves the vertex; NO_INDEX without faces
    """

    origin: NDArray[np.int32]
    twin: NDArray[np.int32]
    outgoing: NDArray[np.int32]


# indptr (n + 1,) int64 and star (3 m,) int32 from connectivity.fill_stars; mesh.twin, filled
@kernel
def find_twins(start, stop, indptr, star, mesh):
    origin = mesh.origin
    for face in range(start, stop):
        first = 3 * face
        for corner in range(3):
            tail = origin[first + corner]
            head = origin[first + (corner + 1) % 3]
            twin = -1
            for k in range(indptr[head], indptr[head + 1]):
                other = 3 * star[k]
                for c in range(3):
                    if origin[other + c] == head and origin[other + (c + 1) % 3] == tail:
                        twin = other + c
            mesh.twin[first + corner] = twin


# mesh.outgoing, filled; n_fans (n,) int8, filled with 0, 1 or 2 (two and more)
@kernel
def find_outgoing(start, stop, indptr, star, mesh, n_fans):
    origin, twin = mesh.origin, mesh.twin
    for vertex in range(start, stop):
        mesh.outgoing[vertex] = -1
        n_open = 0
        for k in range(indptr[vertex], indptr[vertex + 1]):
            first = 3 * star[k]
            for corner in range(3):
                if origin[first + corner] == vertex:
                    if twin[first + corner] < 0:
                        n_open += 1
                        mesh.outgoing[vertex] = first + corner
                    elif mesh.outgoing[vertex] < 0:
                        mesh.outgoing[vertex] = first + corner
        degree = indptr[vertex + 1] - indptr[vertex]
        n_fans[vertex] = 0
        if degree > 0:
            n_walked = 0
            half_edge = mesh.outgoing[vertex]
            while n_walked < degree:
                n_walked += 1
                half_edge = twin[before(half_edge)]
                if half_edge < 0 or half_edge == mesh.outgoing[vertex]:
                    break
            n_fans[vertex] = 1 if n_walked == degree and n_open < 2 else 2


# mesh.outgoing, filled anew: the first half-edge that leaves each vertex, or the one without a twin
@kernel
def renew_outgoing(mesh, face_lives):
    origin, twin, outgoing = mesh.origin, mesh.twin, mesh.outgoing
    outgoing[:] = -1
    for face in range(face_lives.shape[0]):
        if face_lives[face]:
            for half_edge in range(3 * face, 3 * face + 3):
                if outgoing[origin[half_edge]] < 0 or twin[half_edge] < 0:
                    outgoing[origin[half_edge]] = half_edge


@inlined
def moved(half_edge, face_position):
    return 3 * face_position[half_edge // 3] + half_edge % 3 if half_edge >= 0 else -1


# Half-edges of the faces (m,) int32 that live on, renumbered; packed: HalfEdges, filled.
# position (n,), face_position (n_faces,) int32: where each vertex and face goes
@kernel
def pack_faces(start, stop, faces, position, face_position, mesh, packed):
    for k in range(start, stop):
        for corner in range(3):
            half_edge = 3 * faces[k] + corner
            packed.origin[3 * k + corner] = position[mesh.origin[half_edge]]
            packed.twin[3 * k + corner] = moved(mesh.twin[half_edge], face_position)


# The same for the vertices (n,) int32 that live on
@kernel
def pack_vertices(start, stop, vertices, face_position, mesh, packed):
    for k in range(start, stop):
        packed.outgoing[k] = moved(mesh.outgoing[vertices[k]], face_position)


@inlined
def before(half_edge):
    return half_edge + 2 if half_edge % 3 == 0 else half_edge - 1


@inlined
def after(half_edge):
    return half_edge - 2 if half_edge % 3 == 2 else half_edge + 1


# ring, spoke (MAX_RING,) int32, filled: the neighbours of v, counter-clockwise, and the
# half-edges from v to them. Returns (size of the ring, number of faces): equal inside, one more
# neighbour than faces on the outline, (0, 0) if there are too many.
@inlined
def walk_ring(v, origin, twin, outgoing, ring, spoke):
    opening = outgoing[v]
    half_edge = opening
    size = 0
    while size < MAX_RING - 1:
        corner = half_edge % 3
        following = half_edge - 2 if corner == 2 else half_edge + 1
        last = half_edge + 2 if corner == 0 else half_edge - 1
        ring[size] = origin[following]
        spoke[size] = half_edge
        size += 1
        half_edge = twin[last]
        if half_edge < 0:
            ring[size] = origin[last]
            return size + 1, size
        if half_edge == opening:
            return size, size
    return 0, 0


# The link condition: do the rings of v and of its neighbour a share only the vertices that stand
# beside a in the ring of v? Else the collapse of v onto a would join two parts of the mesh.
# ring (>= base + size,) int32 holds the ring of v from `base` on; n_sides: its number of faces.
# The rings are short, so comparing all pairs costs less than marking vertices would.
# _kernels/collapse.py asks the same of a mesh that is not collapsed in place, and of a list of the
# edges made since; test_link_conditions holds the two against each other.
@inlined
def meets_link_condition(a, ring, base, size, n_sides, origin, twin, outgoing):
    opening = outgoing[a]
    half_edge = opening
    n_shared = 0
    while True:
        corner = half_edge % 3
        following = half_edge - 2 if corner == 2 else half_edge + 1
        last = half_edge + 2 if corner == 0 else half_edge - 1
        n_shared += is_among(origin[following], ring, base, size)
        half_edge = twin[last]
        if half_edge < 0:
            n_shared += is_among(origin[last], ring, base, size)
            break
        if half_edge == opening:
            break
    return n_shared == (2 if n_sides == size else 1)


@inlined
def is_among(u, ring, base, size):
    for k in range(base, base + size):  # noqa: SIM110 (numba compiles no generators)
        if ring[k] == u:
            return True
    return False


# Take a face out that has shrunk to the edge between a and `apex`; its other two sides meet.
@inlined
def close_face(face, apex, origin, twin, outgoing):
    half_edge = 3 * face
    while origin[half_edge] != apex:
        half_edge += 1
    inward, outward = twin[half_edge], twin[before(half_edge)]  # to the apex, and from it
    if inward >= 0:
        twin[inward] = outward
    if outward >= 0:
        twin[outward] = inward
    if outgoing[apex] == half_edge:
        outgoing[apex] = outward


# Collapse v onto ring[base]; ring, faces int32 counter-clockwise from there, NO_INDEX where no face
# follows. Faces drop out of face_lives (m,) bool.
@inlined
def collapse(v, ring, faces, base, size, origin, twin, outgoing, face_lives):
    a = ring[base]
    for k in range(base, base + size):
        if faces[k] >= 0:
            half_edge = 3 * faces[k]
            while origin[half_edge] != v:
                half_edge += 1
            origin[half_edge] = a
    for k in (base, base + size - 1):
        if faces[k] >= 0:
            face_lives[faces[k]] = False
            apex = ring[base + 1] if k == base else ring[k]
            close_face(faces[k], apex, origin, twin, outgoing)
    if not face_lives[outgoing[a] // 3]:
        was_outline = twin[outgoing[a]] < 0
        half_edge = 3 * faces[base + 1]  # the first face of the new fan
        while origin[half_edge] != a:
            half_edge += 1
        while was_outline and twin[half_edge] >= 0:  # back to where the fan opens
            half_edge = after(twin[half_edge])
        outgoing[a] = half_edge
