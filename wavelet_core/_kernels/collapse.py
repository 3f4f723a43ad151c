"""Kernels of :mod:`wavelet_core.mesh.collapse`: which half-edge collapses are legal (Fig. 3)."""

from ._jit import njit
from .connectivity import BOUNDARY, INTERIOR
from .outline import COLLINEAR_TOLERANCE, FLATNESS_TOLERANCE


# Is there an edge between two even vertices: in the level's mesh, or made earlier in this pass?
# made_head (n,) int32, made_next and made_end (capacity,) int32: linked lists of edges made
@njit
def are_joined(a, b, faces, indptr, star, made_head, made_next, made_end):
    for k in range(indptr[a], indptr[a + 1]):
        face = star[k]
        if faces[face, 0] == b or faces[face, 1] == b or faces[face, 2] == b:
            return True
    entry = made_head[a]
    while entry >= 0:
        if made_end[entry] == b:
            return True
        entry = made_next[entry]
    entry = made_head[b]
    while entry >= 0:
        if made_end[entry] == a:
            return True
        entry = made_next[entry]
    return False


# points (n, >= 2) float64: doubled plan area of (a, b, c) above the tolerance
@njit
def is_upright(points, a, b, c):
    abx, aby = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    acx, acy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
    bcx, bcy = acx - abx, acy - aby
    longest = max(abx * abx + aby * aby, acx * acx + acy * acy, bcx * bcx + bcy * bcy)
    return abx * acy - aby * acx > FLATNESS_TOLERANCE * longest


# points (n, >= 3) float64: does (a, b, c) face the same way as (v, b, c), and has it area?
@njit
def keeps_normal(points, v, a, b, c):
    bcx, bcy = points[c, 0] - points[b, 0], points[c, 1] - points[b, 1]
    bcz = points[c, 2] - points[b, 2]
    vx, vy, vz = (
        points[b, 0] - points[v, 0],
        points[b, 1] - points[v, 1],
        points[b, 2] - points[v, 2],
    )
    ax, ay, az = (
        points[b, 0] - points[a, 0],
        points[b, 1] - points[a, 1],
        points[b, 2] - points[a, 2],
    )
    ox, oy, oz = vy * bcz - vz * bcy, vz * bcx - vx * bcz, vx * bcy - vy * bcx
    nx, ny, nz = ay * bcz - az * bcy, az * bcx - ax * bcz, ax * bcy - ay * bcx
    longest = max(bcx * bcx + bcy * bcy + bcz * bcz, ax * ax + ay * ay + az * az)
    if nx * nx + ny * ny + nz * nz <= (FLATNESS_TOLERANCE * longest) ** 2:
        return False
    return ox * nx + oy * ny + oz * nz > 0.0


# Does the outline run straight through v, between its outline neighbours p and q?
@njit
def is_collinear(points, p, v, q):
    px, py = points[p, 0] - points[v, 0], points[p, 1] - points[v, 1]
    qx, qy = points[q, 0] - points[v, 0], points[q, 1] - points[v, 1]
    dx, dy = qx - px, qy - py
    chord = dx * dx + dy * dy
    return abs(px * qy - py * qx) <= COLLINEAR_TOLERANCE * chord and px * qx + py * qy < 0.0


# May v be odd at all, whatever the target?
@njit
def is_removable(v, in_plan, points, locked, kind, ring, base, size):
    if locked[v]:
        return False
    if kind[v] == INTERIOR:
        return True
    if kind[v] != BOUNDARY or size < 3:  # pinched, isolated, or a corner with a single face
        return False
    return not in_plan or is_collinear(points, ring[base], v, ring[base + size - 1])


# Would a vertex be left without faces, or, within the surface, with two faces back to back?
@njit
def is_worn_out(v, n_faces_left, kind):
    return n_faces_left < (3 if kind[v] == INTERIOR else 1)


# Is the collapse of v onto its ring entry `position` legal? n_faces_of (n,) int32 is current.
@njit
def is_legal(
    v, position, in_plan, points, faces, indptr, star, ring, base, size, kind, n_faces_of,
    made_head, made_next, made_end,
):  # fmt: skip
    is_outline = kind[v] == BOUNDARY
    if is_outline and position != 0 and position != size - 1:
        return False  # the outline may move along itself only
    target = ring[base + position]
    after = (position + 1) % size
    before = (position - 1) % size
    if not (is_outline and position == size - 1) and is_worn_out(
        ring[base + after], n_faces_of[ring[base + after]] - 1, kind
    ):
        return False
    if not (is_outline and position == 0) and is_worn_out(
        ring[base + before], n_faces_of[ring[base + before]] - 1, kind
    ):
        return False
    n_sides = size - 1 if is_outline else size
    n_shared = 1 if is_outline else 2
    if is_worn_out(target, n_faces_of[target] + n_sides - 2 * n_shared, kind):
        return False
    for k in range(n_sides):
        b, c = ring[base + k], ring[base + (k + 1) % size]
        if b == target or c == target:
            continue
        if in_plan:
            if not is_upright(points, target, b, c):
                return False
        elif not keeps_normal(points, v, target, b, c):
            return False
    for k in range(size):  # link condition
        if k == position:
            continue
        is_next = abs(k - position) == 1 if is_outline else k in (after, before)
        if not is_next and are_joined(
            target, ring[base + k], faces, indptr, star, made_head, made_next, made_end
        ):
            return False
    return True
