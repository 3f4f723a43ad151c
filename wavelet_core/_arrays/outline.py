"""What an outline can do without, on whole arrays; see the kernels of the same name."""

from __future__ import annotations

import numpy as np

from .._kernels.outline import COLLINEAR_TOLERANCE, STAYS, STRAIGHT, outline_rule


def is_straight(px, py, qx, qy):
    dx, dy = qx - px, qy - py
    near = np.abs(px * qy - py * qx) <= COLLINEAR_TOLERANCE * (dx * dx + dy * dy)
    return near & (px * qx + py * qy < 0.0)


def nearest_on_edge(x, y, px, py, qx, qy):
    ex, ey = qx - px, qy - py
    inside = (px - x) * (qy - y) - (py - y) * (qx - x) <= 0.0
    along = ((x - px) * ex + (y - py) * ey) / (ex * ex + ey * ey)
    along = np.minimum(np.maximum(along, 0.0), 1.0) + 0.0  # no -0.0
    return (
        np.where(inside, x, px + along * ex),
        np.where(inside, y, py + along * ey),
        np.where(inside, 0.0, along),
    )


def outline_rules(v, ring, ring_x, ring_y, outline):
    """Return the rule of every vertex, and the share of the new edge at which it is judged.

    With a tolerance each looks along its own stretch of outline, one after the other: they are few.
    """
    rule, along = np.full(len(v), STAYS), np.zeros(len(v))
    if outline.squared_tolerance <= 0.0:
        rule[is_straight(ring_x[:, 0], ring_y[:, 0], ring_x[:, -1], ring_y[:, -1])] = STRAIGHT
        return rule, along
    for k in range(len(v)):
        rule[k], along[k] = outline_rule(
            v[k], ring.shape[1], ring[k], ring_x[k], ring_y[k], outline
        )
    return rule, along
