"""Heights fitted to all input points: the least squares error that a coarse TIN can have."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from .._validate import FloatArray
from ..errors import OptionError
from ..mesh.location import Cover, cover_of
from ..mesh.triangle_mesh import TriangleMesh

#: The fit ends when the gradient has fallen to this part of what it was.
TOLERANCE = 1e-7
#: Or after so many steps; real terrain takes about 40.
MAX_STEPS = 500


def fitted(
    mesh: TriangleMesh,
    original: TriangleMesh,
    locked: ArrayLike | None = None,
    cover: Cover | None = None,
) -> TriangleMesh:
    """Return a coarse mesh whose heights fit the original's vertices best.

    The update of the lifting scheme is local and comes near to this; the fit takes another 6 to
    9 % off the root mean square error of a surface-guided level. Plan positions and faces stay. The
    result is no level of a pyramid: its details would not lead back to the input.

    Parameters
    ----------
    mesh : TriangleMesh
        A coarse TIN, such as ``pyramid.mesh(0)``.
    original : TriangleMesh
        What it shall fit, with the same attributes; only its vertices count.
    locked : array_like of bool, shape (n_vertices,), optional
        Vertices of ``mesh`` that keep their values.
    cover : Cover, optional
        What `cover_of` gives for the original's vertices on the mesh, where it is known already.

    Returns
    -------
    TriangleMesh
        With z and the attributes of the least sum of squared errors at all vertices of
        ``original`` that the mesh covers; each channel by itself.

    Raises
    ------
    OptionError
        Other attributes, or a mask of another size.

    Notes
    -----
    Conjugate gradients on the normal equations, preconditioned by their diagonal. Each vertex lies
    on an input point in a TIN from this package, which keeps the equations well conditioned.
    """
    if mesh.attribute_names != original.attribute_names:
        raise OptionError(
            "{0} has the attributes {of_mesh}, {1} {of_original}; fit a level of its own pyramid.",
            "mesh",
            "original",
            of_mesh=mesh.attribute_names,
            of_original=original.attribute_names,
        )
    free = np.ones(mesh.n_vertices, dtype=bool)
    if locked is not None:
        mask = np.asarray(locked)
        if mask.shape != free.shape or mask.dtype != bool:
            raise OptionError(
                "{0} has shape {shape}; give {due} of bool.",
                "locked",
                shape=mask.shape,
                due=free.shape,
            )
        free = ~mask
    cover = cover_of(mesh, original.vertices[:, :2]) if cover is None else cover
    indices = mesh.faces[cover.face].ravel()
    weights = np.column_stack([1.0 - cover.at_b - cover.at_c, cover.at_b, cover.at_c]).ravel()
    indptr = np.arange(0, len(indices) + 1, 3)
    evaluate = csr_array((weights, indices, indptr), shape=(len(cover.point), mesh.n_vertices))
    gather = evaluate.T.tocsr()
    normal = gather @ evaluate
    columns = np.hstack([mesh.vertices[:, 2:], mesh.attributes])
    measured = np.hstack([original.vertices[:, 2:], original.attributes])[cover.point]
    for channel in range(columns.shape[1]):
        residual = gather @ (measured[:, channel] - evaluate @ columns[:, channel])
        columns[:, channel] += _solve(normal, residual, free)
    vertices = np.column_stack([mesh.vertices[:, :2], columns[:, 0]])
    return TriangleMesh._trusted(
        vertices, mesh.faces, np.ascontiguousarray(columns[:, 1:]), mesh.attribute_names
    )


def _solve(normal: csr_array, right: FloatArray, free: NDArray[np.bool_]) -> FloatArray:
    """Solve for the free unknowns; the others stay 0.

    SciPy's own solver sums with BLAS, whose result depends on the number of threads.
    """
    diagonal = normal.diagonal()
    free = free & (diagonal > 0)
    scale = np.where(free, 1.0 / np.where(free, diagonal, 1.0), 0.0)
    solution = np.zeros(len(right))
    residual = np.where(free, right, 0.0)
    direction = scale * residual
    energy = first = float(np.sum(residual * direction))
    for _ in range(MAX_STEPS):
        if energy <= TOLERANCE**2 * first:
            break
        image = np.where(free, normal @ direction, 0.0)
        step = energy / float(np.sum(direction * image))
        solution += step * direction
        residual -= step * image
        scaled = scale * residual
        energy, before = float(np.sum(residual * scaled)), energy
        direction = scaled + energy / before * direction
    return solution
