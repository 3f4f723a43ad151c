"""Edges that must be in a triangulation, put there by flips where no library does it.

After Sloan, *A fast algorithm for generating constrained Delaunay triangulations* (Computers &
Structures 47, 1993): the edges that cross a given one are flipped until none does, then the new
ones until they are Delaunay. Signs are exact: what floats cannot decide, fractions do.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from .._validate import FloatArray, IntArray
from ..errors import MeshError

__all__ = ["with_edges"]

#: Rounding of the two determinants in doubles, by the sum of the sizes of their terms.
_ORIENT_ERROR, _CIRCLE_ERROR = 1e-15, 4e-15

Edge = tuple[int, int]


def with_edges(plan: FloatArray, faces: IntArray, edges: IntArray) -> IntArray:
    """Return the constrained Delaunay faces in which given edges are.

    Parameters
    ----------
    plan : ndarray, shape (n_vertices, 2)
        Horizontal coordinates, best near zero.
    faces : ndarray of int, shape (n_faces, 3)
        The Delaunay triangulation of the vertices, counter-clockwise.
    edges : ndarray of int, shape (n_edges, 2)
        They may meet at vertices; one that runs through a vertex is cut there.

    Returns
    -------
    ndarray of int, shape (n_faces, 3)

    Raises
    ------
    MeshError
        Edges that cross, or that leave the triangulation.
    """
    mesh = _Flippable(plan, faces)
    for tail, head in edges.tolist():
        mesh.insert(tail, head)
    return mesh.origin.reshape(-1, 3)


class _Crossing(NamedTuple):
    """The edges between a vertex and the next one on the way, and that one."""

    edges: list[Edge]
    reached: int


class _Flippable:
    """A triangulation as half-edges, as in ``_kernels.half_edges``, whose edges can be flipped."""

    def __init__(self, plan: FloatArray, faces: IntArray) -> None:
        self.x, self.y = plan[:, 0], plan[:, 1]
        self.origin: IntArray = faces.astype(np.int64).ravel()
        heads = np.roll(faces, -1, axis=1).ravel()
        n_vertices = len(plan)
        keys = self.origin * n_vertices + heads
        order = np.argsort(keys)
        place = np.searchsorted(keys[order], heads * n_vertices + self.origin)
        found = order[np.minimum(place, len(keys) - 1)]
        self.twin: IntArray = np.where(self.origin[found] == heads, found, -1)
        self.twin[heads[self.twin] != self.origin] = -1
        self.outgoing = np.full(n_vertices, -1, dtype=np.int64)
        self.outgoing[self.origin] = np.arange(len(self.origin))
        outer = np.flatnonzero(self.twin < 0)  # the first of a fan, so that a walk meets all of it
        self.outgoing[self.origin[outer]] = outer
        self.fixed: set[Edge] = set()

    def insert(self, tail: int, head: int) -> None:
        """Make sure that there is an edge, or a row of edges along it."""
        while tail != head:
            crossed, reached = self._crossing(tail, head)
            new = self._flipped_away(tail, reached, crossed)
            self.fixed.add(_sorted(tail, reached))
            self._make_delaunay(new)
            tail = reached

    # Half-edges.

    def _fan(self, vertex: int) -> Iterator[int]:
        """Yield the half-edges that leave a vertex, counter-clockwise."""
        first = h = int(self.outgoing[vertex])
        while True:
            yield h
            h = int(self.twin[_previous(h)])
            if h < 0 or h == first:
                return

    def _head(self, h: int) -> int:
        return int(self.origin[_next(h)])

    def _apex(self, h: int) -> int:
        return int(self.origin[_previous(h)])

    def _find(self, tail: int, head: int) -> int:
        """Return the half-edge from one vertex to another, one that has a twin."""
        return next(h for h in self._fan(tail) if self._head(h) == head)

    def _flip(self, h: int) -> None:
        """Exchange an edge for the other diagonal of its two faces."""
        t = int(self.twin[h])
        u, v, p, r = self._head(t), self._head(h), self._apex(h), self._apex(t)
        f, g = 3 * (h // 3), 3 * (t // 3)
        outside = [int(self.twin[k]) for k in (_next(t), _previous(h), _previous(t), _next(h))]
        self.origin[f : f + 3] = u, r, p
        self.origin[g : g + 3] = r, v, p
        for own, other in zip((f, f + 2, g, g + 1), outside, strict=True):
            self.twin[own] = other
            if other >= 0:
                self.twin[other] = own
        self.twin[f + 1], self.twin[g + 2] = g + 2, f + 1
        for vertex, own in ((u, f), (v, g + 1), (p, f + 2), (r, g)):
            if self.outgoing[vertex] // 3 in (f // 3, g // 3):
                self.outgoing[vertex] = own

    # Steps.

    def _crossing(self, tail: int, head: int) -> _Crossing:
        """Walk from a vertex towards another, as far as the first vertex on the way."""
        e = -1
        for h in self._fan(tail):
            right, left = self._head(h), self._apex(h)
            for vertex in (right, left):
                if vertex == head or (
                    self._side(tail, head, vertex) == 0 and self._is_ahead(tail, head, vertex)
                ):
                    return _Crossing([], vertex)
            if self._side(tail, head, right) < 0 < self._side(tail, head, left):
                e = _next(h)
                break
        crossed = []
        while e >= 0 and self.twin[e] >= 0:
            edge = _sorted(int(self.origin[e]), self._head(e))
            if edge in self.fixed:
                raise MeshError(
                    f"constraint edges cannot be inserted ({tail}-{head} crosses "
                    f"{edge[0]}-{edge[1]}); split them where they cross."
                )
            crossed.append(edge)
            t = int(self.twin[e])
            apex = self._apex(t)
            side = self._side(tail, head, apex)
            if apex == head or side == 0:
                return _Crossing(crossed, apex)
            e = _next(t) if side > 0 else _previous(t)
        raise MeshError(
            f"constraint edge {tail}-{head} leaves the triangulation of the points, whose outline "
            "is not convex to rounding; move one of its ends inwards."
        )

    def _flipped_away(self, tail: int, head: int, crossed: list[Edge]) -> list[Edge]:
        """Flip edges until none crosses a given one; return those that are new."""
        waiting = deque(crossed)
        new: list[Edge] = []
        while waiting:
            u, v = waiting.popleft()
            h = self._find(u, v)
            p, r = self._apex(h), self._apex(int(self.twin[h]))
            if not (self._side(u, r, p) > 0 and self._side(r, v, p) > 0):  # not convex, yet
                waiting.append((u, v))
                continue
            self._flip(h)
            is_at_end = p in (tail, head) or r in (tail, head)
            is_across = self._side(tail, head, p) * self._side(tail, head, r) < 0
            (waiting if is_across and not is_at_end else new).append((p, r))
        return new

    def _make_delaunay(self, edges: list[Edge]) -> None:
        """Flip new edges until the circle around each face is empty, or a fixed edge is between."""
        has_changed = True
        while has_changed:
            has_changed = False
            for k, (u, v) in enumerate(edges):
                if _sorted(u, v) in self.fixed:
                    continue
                h = self._find(u, v)
                p, r = self._apex(h), self._apex(int(self.twin[h]))
                if self._is_in_circle(u, v, p, r):
                    self._flip(h)
                    edges[k] = (p, r)
                    has_changed = True

    # Signs.

    def _points(self, *vertices: int) -> list[tuple[float, float]]:
        return [(float(self.x[vertex]), float(self.y[vertex])) for vertex in vertices]

    def _side(self, tail: int, head: int, vertex: int) -> int:
        """Return 1 for a vertex left of an edge, -1 for one right of it, 0 for one on its line."""
        (ax, ay), (bx, by), (cx, cy) = self._points(tail, head, vertex)
        one, other = (bx - ax) * (cy - ay), (by - ay) * (cx - ax)
        area = one - other
        if abs(area) <= _ORIENT_ERROR * (abs(one) + abs(other)):
            ax, ay, bx, by, cx, cy = map(Fraction, (ax, ay, bx, by, cx, cy))  # type: ignore[assignment]
            area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        return (area > 0) - (area < 0)

    def _is_ahead(self, tail: int, head: int, vertex: int) -> bool:
        (ax, ay), (bx, by), (cx, cy) = self._points(tail, head, vertex)
        return (bx - ax) * (cx - ax) + (by - ay) * (cy - ay) > 0

    def _is_in_circle(self, u: int, v: int, p: int, r: int) -> bool:
        """Whether r is inside the circle around the face u, v, p."""
        (rx, ry), *corners = self._points(r, u, v, p)
        (a, b), (c, d), (e, f) = ((x - rx, y - ry) for x, y in corners)
        squares = a * a + b * b, c * c + d * d, e * e + f * f
        terms = (c * f, -d * e), (b * e, -a * f), (a * d, -b * c)
        value = sum(square * (s + t) for square, (s, t) in zip(squares, terms, strict=True))
        size = sum(
            square * (abs(s) + abs(t)) for square, (s, t) in zip(squares, terms, strict=True)
        )
        if abs(value) > _CIRCLE_ERROR * size:
            return value > 0
        rx, ry = Fraction(rx), Fraction(ry)  # type: ignore[assignment]
        (a, b), (c, d), (e, f) = ((Fraction(x) - rx, Fraction(y) - ry) for x, y in corners)
        value = (
            (a * a + b * b) * (c * f - d * e)
            - (c * c + d * d) * (a * f - b * e)
            + (e * e + f * f) * (a * d - b * c)
        )
        return value > 0


def _next(h: int) -> int:
    return h - 2 if h % 3 == 2 else h + 1


def _previous(h: int) -> int:
    return h + 2 if h % 3 == 0 else h - 1


def _sorted(u: int, v: int) -> Edge:
    return (u, v) if u < v else (v, u)
