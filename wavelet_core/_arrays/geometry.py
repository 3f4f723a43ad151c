"""Lengths, areas and curvature on whole arrays; see :mod:`wavelet_core._kernels.geometry`."""

from __future__ import annotations

import math

import numpy as np

from ._rings import by_size


def _cross(ux, uy, uz, vx, vy, vz):
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


def _angles(y, x):
    """Arc tangents from the C library, as the kernels take them: numpy's may round otherwise."""
    return np.fromiter(map(math.atan2, y.tolist(), x.tolist()), np.float64, len(y))


def total_curvatures(start, stop, points, faces, indptr, star, kind, curvature):
    curvature[:] = 0.0
    interior = np.flatnonzero(kind == 0)
    degree = np.diff(indptr)[interior]
    for size, rows in by_size(degree):
        v = interior[rows]
        n = len(v)
        angle_sum, mixed_area = np.zeros(n), np.zeros(n)
        normal_x, normal_y, normal_z = np.zeros(n), np.zeros(n), np.zeros(n)
        for k in range(size):
            face = faces[star[indptr[v] + k]]
            corner = np.where(face[:, 1] == v, 1, np.where(face[:, 2] == v, 2, 0))
            every = np.arange(n)
            b, c = face[every, (corner + 1) % 3], face[every, (corner + 2) % 3]
            bx, by, bz = (points[b, i] - points[v, i] for i in range(3))
            cx, cy, cz = (points[c, i] - points[v, i] for i in range(3))
            bb = bx * bx + by * by + bz * bz
            cc = cx * cx + cy * cy + cz * cz
            bc = bx * cx + by * cy + bz * cz
            nx, ny, nz = _cross(bx, by, bz, cx, cy, cz)
            doubled_area = np.sqrt(nx * nx + ny * ny + nz * nz)
            has_area = doubled_area > 0.0
            divisor = np.where(has_area, doubled_area, 1.0)
            cot_b, cot_c = (bb - bc) / divisor, (cc - bc) / divisor
            angle_sum[has_area] += _angles(doubled_area[has_area], bc[has_area])
            normal_x -= np.where(has_area, cot_b * cx + cot_c * bx, 0.0)
            normal_y -= np.where(has_area, cot_b * cy + cot_c * by, 0.0)
            normal_z -= np.where(has_area, cot_b * cz + cot_c * bz, 0.0)
            share = np.where(
                bc < 0.0,
                doubled_area / 4.0,
                np.where(
                    (cot_b < 0.0) | (cot_c < 0.0),
                    doubled_area / 8.0,
                    (cot_b * cc + cot_c * bb) / 8.0,
                ),
            )
            mixed_area += np.where(has_area, share, 0.0)
        sound = mixed_area > 0.0
        mixed_area = np.where(sound, mixed_area, 1.0)
        gaussian = (2.0 * math.pi - angle_sum) / mixed_area
        length = np.sqrt(normal_x * normal_x + normal_y * normal_y + normal_z * normal_z)
        mean = length / (4.0 * mixed_area)
        total = np.maximum(4.0 * mean * mean - 2.0 * gaussian, 0.0)
        curvature[v] = np.where(sound, total, 0.0)


def bending_energies(start, stop, points, faces, indptr, star, curvature, energy):
    a, b, c = faces.T
    bx, by, bz = (points[b, i] - points[a, i] for i in range(3))
    cx, cy, cz = (points[c, i] - points[a, i] for i in range(3))
    nx, ny, nz = _cross(bx, by, bz, cx, cy, cz)
    doubled_area = np.sqrt(nx * nx + ny * ny + nz * nz)
    of_face = (curvature[a] + curvature[b] + curvature[c]) / 6.0 * doubled_area
    vertex = np.repeat(np.arange(len(energy)), np.diff(indptr))
    energy[:] = np.bincount(vertex, of_face[star], minlength=len(energy))


def measure_faces(start, stop, plan, faces, nearest, longest, doubled):
    block = faces[start:stop]
    corners = plan[block, :2]
    sides = np.roll(corners, -1, axis=1) - corners
    squared = sides[..., 0] * sides[..., 0] + sides[..., 1] * sides[..., 1]
    for k in range(3):
        np.minimum.at(nearest, block[:, k], squared[:, k])
        np.minimum.at(nearest, block[:, (k + 1) % 3], squared[:, k])
    longest[start:stop] = squared.max(axis=1)
    doubled[start:stop] = np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])
