"""Kernels of lengths, areas and curvature: :mod:`wavelet_core.mesh.curvature` and `.gaps`."""

import math

from ._jit import kernel


# points (n, >= 3) float64, the first three columns are used; faces (n_faces, 3) int32;
# kind (n,) int8, 0 is interior; curvature (n,) float64, filled with 4 H^2 - 2 K, at least 0
@kernel
def total_curvatures(start, stop, points, faces, indptr, star, kind, curvature):
    for vertex in range(start, stop):
        curvature[vertex] = 0.0
        if kind[vertex] != 0:
            continue
        angle_sum, mixed_area = 0.0, 0.0
        normal_x, normal_y, normal_z = 0.0, 0.0, 0.0
        for k in range(indptr[vertex], indptr[vertex + 1]):
            face = star[k]
            corner = 0
            if faces[face, 1] == vertex:
                corner = 1
            elif faces[face, 2] == vertex:
                corner = 2
            b, c = faces[face, (corner + 1) % 3], faces[face, (corner + 2) % 3]
            bx = points[b, 0] - points[vertex, 0]
            by = points[b, 1] - points[vertex, 1]
            bz = points[b, 2] - points[vertex, 2]
            cx = points[c, 0] - points[vertex, 0]
            cy = points[c, 1] - points[vertex, 1]
            cz = points[c, 2] - points[vertex, 2]
            bb = bx * bx + by * by + bz * bz
            cc = cx * cx + cy * cy + cz * cz
            bc = bx * cx + by * cy + bz * cz
            nx, ny, nz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
            doubled_area = math.sqrt(nx * nx + ny * ny + nz * nz)
            if doubled_area <= 0.0:
                continue
            angle_sum += math.atan2(doubled_area, bc)
            cot_b = (bb - bc) / doubled_area  # angle at b, opposite the edge to c
            cot_c = (cc - bc) / doubled_area
            normal_x -= cot_b * cx + cot_c * bx
            normal_y -= cot_b * cy + cot_c * by
            normal_z -= cot_b * cz + cot_c * bz
            if bc < 0.0:  # obtuse at the vertex
                mixed_area += doubled_area / 4.0
            elif cot_b < 0.0 or cot_c < 0.0:
                mixed_area += doubled_area / 8.0
            else:
                mixed_area += (cot_b * cc + cot_c * bb) / 8.0
        if mixed_area <= 0.0:
            continue
        gaussian = (2.0 * math.pi - angle_sum) / mixed_area
        length = math.sqrt(normal_x * normal_x + normal_y * normal_y + normal_z * normal_z)
        mean = length / (4.0 * mixed_area)
        curvature[vertex] = max(4.0 * mean * mean - 2.0 * gaussian, 0.0)


# Eq. 38; energy (n,) float64, filled
@kernel
def bending_energies(start, stop, points, faces, indptr, star, curvature, energy):
    for vertex in range(start, stop):
        total = 0.0
        for k in range(indptr[vertex], indptr[vertex + 1]):
            face = star[k]
            a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
            bx, by = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
            bz = points[b, 2] - points[a, 2]
            cx, cy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
            cz = points[c, 2] - points[a, 2]
            nx, ny, nz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
            doubled_area = math.sqrt(nx * nx + ny * ny + nz * nz)
            total += (curvature[a] + curvature[b] + curvature[c]) / 6.0 * doubled_area
        energy[vertex] = total


# Squared lengths in plan: nearest (n,) float64, lowered to that of the shortest edge of each
# vertex, longest (n_faces,) float64 and doubled (n_faces,) float64, twice the area, filled.
# plan (n, >= 2) float64; faces (n_faces, 3) int64
@kernel
def measure_faces(start, stop, plan, faces, nearest, longest, doubled):
    for face in range(start, stop):
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        abx, aby = plan[b, 0] - plan[a, 0], plan[b, 1] - plan[a, 1]
        bcx, bcy = plan[c, 0] - plan[b, 0], plan[c, 1] - plan[b, 1]
        cax, cay = plan[a, 0] - plan[c, 0], plan[a, 1] - plan[c, 1]
        ab, bc, ca = abx * abx + aby * aby, bcx * bcx + bcy * bcy, cax * cax + cay * cay
        nearest[a] = min(nearest[a], ab, ca)
        nearest[b] = min(nearest[b], ab, bc)
        nearest[c] = min(nearest[c], bc, ca)
        longest[face] = max(ab, bc, ca)
        doubled[face] = abs(abx * bcy - aby * bcx)
