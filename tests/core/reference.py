"""A slow, plain second opinion on the lifting scheme, written from the equations of the paper.

Loops, dense matrices and sets; no numba and nothing from ``wavelet_core``. Equation numbers are
those of *Graph-Based Wavelet Multiresolution Modeling of Multivariate Terrain Data*; what the
paper leaves open follows the choices that ``docs/science/theory.md`` states.

Meshes are lists of vertex triples. ``points`` are normalised columns (x, y, z, attributes).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.optimize import nnls

Face = tuple[int, int, int]

#: A face whose doubled-then-halved plan area is no more than this times its longest edge
#: squared counts as flat.
FLAT = 1e-9
#: The filters that are worked out here once more.
PREDICTIONS = (
    "uniform",
    "cotangent",
    "geometric",
    "nnls",
    "least_squares",
    "barycentric",
    "plane",
)
UPDATES = ("martinez_ortega", "one_ring_mean", "minimum_norm", "none")


# --- topology ---------------------------------------------------------------------------------


def star(faces: list[Face], v: int) -> list[Face]:
    """Return the faces at ``v``, each turned so that ``v`` comes first."""
    turned = []
    for face in faces:
        if v in face:
            k = face.index(v)
            turned.append((v, face[(k + 1) % 3], face[(k + 2) % 3]))
    return turned


def one_ring(faces: list[Face], v: int) -> list[int]:
    """Return the neighbours of ``v``, ascending."""
    return sorted({w for face in faces if v in face for w in face} - {v})


def kind(faces: list[Face], v: int) -> str:
    """Return what ``v`` is: interior, boundary, pinch (several fans) or isolated."""
    spokes = star(faces, v)
    if not spokes:
        return "isolated"
    following = {a: b for _, a, b in spokes}
    starts = [a for a in following if a not in following.values()]
    walked = 0
    if starts:
        a = starts[0]
        while a in following:
            a = following[a]
            walked += 1
        return "boundary" if walked == len(spokes) else "pinch"
    first = a = spokes[0][1]
    while True:
        a = following[a]
        walked += 1
        if a == first:
            break
    return "interior" if walked == len(spokes) else "pinch"


def outline_neighbours(faces: list[Face], v: int) -> set[int]:
    """Return the neighbours of ``v`` along edges with a single face."""
    return {w for w in one_ring(faces, v) if sum(v in f and w in f for f in faces) == 1}


def collapse(faces: list[Face], odd: int, target: int) -> list[Face]:
    """Return the faces after ``odd`` has moved onto ``target``."""
    moved = [tuple(target if w == odd else w for w in face) for face in faces]
    return [face for face in moved if len(set(face)) == 3]


# --- geometry ---------------------------------------------------------------------------------


def plan_area(plan: np.ndarray, face: Face) -> float:
    """Return the signed plan area of a face; positive is counter-clockwise."""
    (ax, ay), (bx, by), (cx, cy) = (plan[w] for w in face)
    return 0.5 * ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))


def is_flat_in_plan(plan: np.ndarray, face: Face) -> bool:
    """Whether the face is flipped in plan or has (next to) no area there."""
    a, b, c = (plan[w] for w in face)
    longest = max(np.sum((b - a) ** 2), np.sum((c - b) ** 2), np.sum((a - c) ** 2))
    return plan_area(plan, face) <= FLAT * longest


def normal(points: np.ndarray, face: Face) -> np.ndarray:
    """Return the normal of a face in x, y, z, as long as twice its area."""
    a, b, c = (points[w, :3] for w in face)
    return np.cross(b - a, c - a)


def angle(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> float:
    """Return the angle at ``a`` between the directions to ``b`` and ``c``."""
    u, w = b - a, c - a
    return math.acos(np.clip(u @ w / (np.linalg.norm(u) * np.linalg.norm(w)), -1, 1))


def cotangent(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> float:
    """Return the cotangent of the angle at ``a``."""
    u, w = b - a, c - a
    return (u @ w) / np.linalg.norm(np.cross(u, w))


def mixed_area(points: np.ndarray, faces: list[Face], v: int) -> float:
    """Return Meyer's mixed area at ``v``: Voronoi, or a share of the face where it is obtuse."""
    total = 0.0
    for _, q, r in star(faces, v):
        p, q, r = points[v, :3], points[q, :3], points[r, :3]
        area = 0.5 * np.linalg.norm(np.cross(q - p, r - p))
        if angle(p, q, r) > math.pi / 2:
            total += area / 2
        elif angle(q, r, p) > math.pi / 2 or angle(r, p, q) > math.pi / 2:
            total += area / 4
        else:
            total += (np.sum((r - p) ** 2) * cotangent(q, r, p)) / 8
            total += (np.sum((q - p) ** 2) * cotangent(r, p, q)) / 8
    return total


def squared_curvatures(points: np.ndarray, faces: list[Face], v: int) -> float:
    """Return 4 H² - 2 K at ``v``, not below 0; 0 wherever ``v`` has no closed ring."""
    if kind(faces, v) != "interior":
        return 0.0
    p = points[v, :3]
    deficit = 2 * math.pi
    laplacian = np.zeros(3)
    for _, q, r in star(faces, v):
        q, r = points[q, :3], points[r, :3]
        deficit -= angle(p, q, r)
        laplacian += cotangent(r, p, q) * (p - q)
        laplacian += cotangent(q, r, p) * (p - r)
    area = mixed_area(points, faces, v)
    gaussian = deficit / area
    mean = np.linalg.norm(laplacian) / (4 * area)
    return max(4 * mean**2 - 2 * gaussian, 0.0)


def bending_energies(points: np.ndarray, faces: list[Face]) -> np.ndarray:
    """Return the bending energy of every vertex (Algorithm 1, Eq. 38)."""
    f = [squared_curvatures(points, faces, v) for v in range(len(points))]
    energy = np.zeros(len(points))
    for face in faces:
        doubled_area = np.linalg.norm(normal(points, face))
        share = sum(f[w] for w in face) / 6 * doubled_area
        for w in face:
            energy[w] += share
    return energy


# --- prediction (Eqs. 39-42) ------------------------------------------------------------------


def cotangent_sum(points: np.ndarray, faces: list[Face], v: int, w: int) -> float:
    """Return cot α + cot β of the angles opposite the edge v-w (one term on the outline)."""
    total = 0.0
    for face in faces:
        if v in face and w in face:
            (opposite,) = set(face) - {v, w}
            total += cotangent(points[opposite, :3], points[v, :3], points[w, :3])
    return total


def prediction_weights(
    method: str,
    points: np.ndarray,
    plan: np.ndarray,
    faces: list[Face],
    odd: int,
    target: int,
) -> dict[int, float]:
    """Return the weight of each neighbour in the prediction of ``odd``."""
    ring = one_ring(faces, odd)
    if method == "barycentric":
        return barycentric_weights(plan, faces, odd, target)
    if method == "plane":
        # The value at the vertex of the plane fitted to the ring: row 0 of the pseudo-inverse.
        offsets = plan[ring] - plan[odd]
        omega = np.linalg.pinv(np.column_stack([np.ones(len(ring)), offsets]))[0]
    elif method == "uniform":
        omega = np.ones(len(ring))
    elif method == "cotangent":
        omega = np.array([max(cotangent_sum(points, faces, odd, w), 0.0) for w in ring])
        if omega.sum() <= 0:
            omega = np.ones(len(ring))
    elif method == "geometric":
        omega = np.array([1 / np.linalg.norm(points[w] - points[odd]) for w in ring])
    else:
        omega = fitted_weights(method, points, ring, odd)
    return dict(zip(ring, omega / omega.sum(), strict=True))


def fitted_weights(method: str, points: np.ndarray, ring: list[int], odd: int) -> np.ndarray:
    """Return the weights that leave the smallest detail, damped, before they are scaled to sum 1.

    min ||Σ p_i (r_i - v)||² + λ ||p||² with Σ p = 1 has the direction of the minimiser of
    ||Σ p_i (r_i - v)||² + λ ||p||² + (1 - Σ p)², with or without p >= 0: both are the same
    quadratic on rays through the origin.
    """
    offsets = np.array([points[w] - points[odd] for w in ring])
    damping = 1e-8 * np.mean(np.sum(offsets**2, axis=1))
    n = len(ring)
    matrix = np.vstack([offsets.T, math.sqrt(damping) * np.eye(n), np.ones((1, n))])
    right = np.zeros(len(matrix))
    right[-1] = 1.0
    fits = {"nnls": nnls, "least_squares": np.linalg.lstsq}
    return fits[method](matrix, right)[0]


def barycentric_weights(
    plan: np.ndarray, faces: list[Face], odd: int, target: int
) -> dict[int, float]:
    """Return the coordinates of ``odd`` in the face that covers it after its collapse."""
    new = collapse(star(faces, odd), odd, target)
    best: dict[int, float] = {}
    best_least = -math.inf
    for face in new:
        whole = plan_area(plan, face)
        a, b, c = face
        coordinates = [
            plan_area(plan, sub) / whole for sub in ((odd, b, c), (a, odd, c), (a, b, odd))
        ]
        if min(coordinates) > best_least:
            best_least = min(coordinates)
            best = dict(zip(face, coordinates, strict=True))
    assert best_least > -1e-9, f"no face covers vertex {odd} after its collapse onto {target}"
    return best


# --- update (Eqs. 43-51) ----------------------------------------------------------------------


def update_matrix(
    method: str, p: np.ndarray, support: list[list[int]], zeta_odd: np.ndarray, zeta: np.ndarray
) -> np.ndarray:
    """Return U, (n_even, n_odd), for the methods that have one.

    ``support[k]`` are the positions among the even vertices that odd vertex k may change.
    """
    n_odd, n_even = p.shape
    u = np.zeros((n_even, n_odd))
    for k in range(n_odd):
        for m in support[k]:
            if method == "martinez_ortega":  # Eq. 43
                total = p[:, m].sum()
                u[m, k] = 0.5 * p[k, m] / total if total else 0.0
            elif method == "minimum_norm":  # Eq. 50
                u[m, k] = zeta_odd[k] * zeta[m] / sum(zeta[i] ** 2 for i in support[k])
            elif method == "one_ring_mean":  # Eq. 46, the part that multiplies the detail
                u[m, k] = 1 / (len(support[k]) + 1)
    return u


def one_ring_mean_update(
    s: np.ndarray, w: np.ndarray, p: np.ndarray, support: list[list[int]]
) -> np.ndarray:
    """Return the even coefficients after Eq. 46, one odd vertex after the other.

    Where the support leaves locked vertices out, p is shifted to sum to 1 over what remains.
    """
    s = s.copy()
    for k, ring in enumerate(support):
        n = len(ring)
        if n == 0:
            continue
        share = p[k, ring] + (1 - p[k, ring].sum()) / n
        change = w[k] / (n + 1)
        for weight, m in zip(share, ring, strict=True):
            change = change + (n * weight - 1) / (n * (n + 1)) * s[m]
        s[ring] += change
    return s


# --- quadrics and partition (Eqs. 34-36, 52-53, Algorithm 2) ----------------------------------


@dataclass
class Quadrics:
    """Squared distances to the planes of the input's faces in R^(n+1), summed with weights.

    ``share[v]`` says how much of each input face's quadric vertex v holds; kept as a sum of
    projections rather than as matrices, so that no packing can be wrong.
    """

    planes: list[tuple[np.ndarray, np.ndarray, np.ndarray]]
    share: dict[int, dict[int, float]]

    @classmethod
    def from_mesh(cls, points: np.ndarray, faces: list[Face]) -> Quadrics:
        """Return the quadrics of a level: each vertex holds its faces' (Eq. 35)."""
        planes = []
        share: dict[int, dict[int, float]] = {v: {} for v in range(len(points))}
        for k, (a, b, c) in enumerate(faces):
            e1 = points[b] - points[a]
            e1 = e1 / np.linalg.norm(e1)
            e2 = points[c] - points[a]
            e2 = e2 - (e2 @ e1) * e1
            e2 = e2 / np.linalg.norm(e2)
            planes.append((points[a], e1, e2))
            for w in (a, b, c):
                share[w][k] = 1.0
        return cls(planes, share)

    def error(self, v: int, point: np.ndarray) -> float:
        """Return ``point``'s summed squared distance to the planes that ``v`` holds (Eq. 34)."""
        total = 0.0
        for k, weight in self.share[v].items():
            origin, e1, e2 = self.planes[k]
            d = point - origin
            d = d - (d @ e1) * e1 - (d @ e2) * e2
            total += weight * (d @ d)
        return total if total > 1e-14 else 0.0  # else rounding would tell equal targets apart

    def redistributed(self, odd: list[int], even: list[int], p: np.ndarray) -> Quadrics:
        """Return the even vertices' quadrics after the odd ones passed theirs on (Eqs. 52-53)."""
        share = {m: dict(self.share[v]) for m, v in enumerate(even)}
        for k, v in enumerate(odd):
            rho = np.maximum(p[k], 0.0)
            rho = rho / rho.sum()
            for m in np.flatnonzero(rho):
                for plane, weight in self.share[v].items():
                    share[m][plane] = share[m].get(plane, 0.0) + rho[m] * weight
        return Quadrics(self.planes, share)


def is_straight_outline(plan: np.ndarray, faces: list[Face], v: int) -> bool:
    """Whether the outline runs straight through ``v``, so that it stays as it is without it."""
    ends = sorted(outline_neighbours(faces, v))
    if len(ends) != 2:
        return False
    a, b = ends
    sides = [plan[w] - plan[v] for w in ends]
    flat = is_flat_in_plan(plan, (v, a, b)) and is_flat_in_plan(plan, (v, b, a))
    return flat and sides[0] @ sides[1] < 0


def is_legal(
    current: list[Face],
    v: int,
    a: int,
    points: np.ndarray,
    plan: np.ndarray,
    signal: str,
) -> bool:
    """Whether ``v`` may collapse onto its neighbour ``a`` in the mesh as it now stands (Fig. 3)."""
    what = kind(current, v)
    if what in ("isolated", "pinch"):
        return False
    if what == "boundary":
        if len(star(current, v)) == 1 or a not in outline_neighbours(current, v):
            return False
        if signal == "z" and not is_straight_outline(plan, current, v):
            return False
    shared = [f for f in current if v in f and a in f]
    opposite = {w for f in shared for w in f} - {v, a}
    if set(one_ring(current, v)) & set(one_ring(current, a)) != opposite:
        return False
    if any(len(star(current, w)) == 1 for w in opposite):
        return False
    new = collapse(star(current, v), v, a)
    rest = {frozenset(f) for f in current if v not in f}
    if any(frozenset(f) in rest for f in new):
        return False
    for old in star(current, v):
        if a in old:
            continue
        moved = tuple(a if w == v else w for w in old)
        if signal == "z" and is_flat_in_plan(plan, moved):
            return False
        if signal == "xyz" and normal(points, old) @ normal(points, moved) <= 0:
            return False
    return True


def partition(
    points: np.ndarray,
    plan: np.ndarray,
    faces: list[Face],
    extended: np.ndarray,
    quadrics: Quadrics,
    locked: np.ndarray,
    signal: str,
    rank: str = "ring",
) -> tuple[list[int], list[int]]:
    """Return odd vertices in removal order and their targets (Algorithm 2).

    ``extended`` are the points with the bending coordinate.
    """
    cost = np.zeros(len(points))
    for v in range(len(points)):
        if kind(faces, v) in ("interior", "boundary"):
            errors = [quadrics.error(w, extended[v]) for w in one_ring(faces, v)]
            cost[v] = sum(errors) if rank == "ring" else min(errors)
    marked = set(np.flatnonzero(locked).tolist())
    odd, targets = [], []
    current = list(faces)
    for v in sorted(range(len(points)), key=lambda v: (cost[v], v)):
        if v in marked:
            continue
        marked.add(v)
        legal = [a for a in one_ring(current, v) if is_legal(current, v, a, points, plan, signal)]
        if not legal:
            continue
        target = min(legal, key=lambda a: (quadrics.error(a, extended[v]), a))
        marked.update(one_ring(current, v))
        current = collapse(current, v, target)
        odd.append(v)
        targets.append(target)
    return odd, targets


# --- the transform (Eqs. 30-33, Algorithm 3) --------------------------------------------------


@dataclass
class Step:
    """One analysis step, with everything that the paper stores and more."""

    odd: list[int]
    target: list[int]
    even: list[int]
    p: np.ndarray
    u: np.ndarray | None
    w: np.ndarray
    s: np.ndarray  # of the coarser level
    zeta: np.ndarray  # of the coarser level
    faces: list[Face]  # of the coarser level


@dataclass
class Analysis:
    """A whole analysis; ``steps[0]`` is the first one carried out, from level L to L - 1."""

    steps: list[Step] = field(default_factory=list)


def analyse(
    vertices: Any,
    faces: Any,
    attributes: Any = None,
    *,
    levels: int,
    prediction: str,
    update: str,
    signal: str,
    locked: Any = None,
    bending_weight: float = 1.0,
    quadrics_of: str = "redistributed",
    cost: str = "ring",
    attribute_weights: Any = None,
    partitions: list[tuple[list[int], list[int]]] | None = None,
    filters: list[tuple[np.ndarray, np.ndarray]] | None = None,
) -> Analysis:
    """Return the reference analysis; with ``partitions``, of given odd vertices and targets.

    ``filters``, P and U of each step, stand in for those that are not in ``PREDICTIONS`` or
    ``UPDATES``; all others are worked out here.
    """
    columns = np.asarray(vertices, dtype=float)
    if attributes is not None and np.size(attributes):
        columns = np.column_stack([columns, attributes])
    centre, span = columns.min(axis=0), np.ptp(columns, axis=0)
    span[span == 0] = 1.0
    column_weights = np.ones(columns.shape[1])
    if attribute_weights is not None:
        column_weights[3:] = attribute_weights
    lifted = slice(2, None) if signal == "z" else slice(0, None)
    level_faces = [tuple(int(w) for w in face) for face in faces]
    is_locked = np.zeros(len(columns), bool) if locked is None else np.array(locked, bool)
    zeta = np.ones(len(columns))
    quadrics = None
    energy_scale = None
    result = Analysis()
    for step in range(levels):
        points = (columns - centre) / span * column_weights
        plan = columns[:, :2]
        if partitions is None:
            energy = bending_energies(points, level_faces)
            if energy_scale is None:
                energy_scale = np.percentile(energy, 99)
            bending = np.zeros(len(points))
            if energy_scale > 0:
                bending = np.minimum(np.sqrt(energy / energy_scale), 1.0) * bending_weight
            extended = np.column_stack([points, bending])
            if quadrics is None or quadrics_of == "rebuilt":
                quadrics = Quadrics.from_mesh(extended, level_faces)
            odd, target = partition(
                points, plan, level_faces, extended, quadrics, is_locked, signal, cost
            )
        elif step < len(partitions):
            odd, target = ([int(v) for v in ids] for ids in partitions[step])
        else:
            break
        if not odd:
            break
        even = sorted(set(range(len(points))) - set(odd))
        position = {v: m for m, v in enumerate(even)}

        p = np.zeros((len(odd), len(even)))
        support = []
        for k, v in enumerate(odd):
            if prediction in PREDICTIONS:
                weights = prediction_weights(prediction, points, plan, level_faces, v, target[k])
            else:
                row = filters[step][0][k]
                weights = {even[m]: row[m] for m in np.flatnonzero(row)}
            for neighbour, weight in weights.items():
                p[k, position[neighbour]] = weight
            ring = [m for m in weights if not is_locked[m]]
            if not ring:
                ring = [m for m in one_ring(level_faces, v) if not is_locked[m]]
            support.append(sorted(position[m] for m in ring))

        s_even, s_odd = columns[even][:, lifted], columns[odd][:, lifted]
        w = s_odd - p @ s_even  # Eq. 30
        coarse_zeta = zeta[even] + p.T @ zeta[odd]  # Eq. 47
        if update not in UPDATES:
            u = filters[step][1]
        elif update == "none":
            u = None
        else:
            u = update_matrix(update, p, support, zeta[odd], coarse_zeta)
        if update == "one_ring_mean":
            s = one_ring_mean_update(s_even, w, p, support)
        else:
            s = s_even if u is None else s_even + u @ w  # Eq. 31

        coarse_faces = level_faces
        for v, a in zip(odd, target, strict=True):
            coarse_faces = collapse(coarse_faces, v, a)
        coarse_faces = [tuple(position[x] for x in face) for face in coarse_faces]
        result.steps.append(Step(odd, target, even, p, u, w, s, coarse_zeta, coarse_faces))

        if quadrics is not None:
            quadrics = quadrics.redistributed(odd, even, p)
        columns = columns[even].copy()
        columns[:, lifted] = s
        level_faces, zeta, is_locked = coarse_faces, coarse_zeta, is_locked[even]
    return result
