"""The partitions and the norms by their names: what each is for, takes, and is made of."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from numpy.typing import NDArray

from .._table import Table
from .._validate import FloatArray
from . import orderings
from ._mutable_level import SurfaceLevel
from .error_guided import REMOVAL_FRACTION

#: Share of the vertices that a level may take where the largest error is kept small at a given
#: size: smaller steps keep it 4 to 10 % lower for a third more time (docs/topics/surface.md).
MAX_NORM_REMOVAL_FRACTION = 0.1


class PartitionInput(NamedTuple):
    """What a partition may be made from: the input, and the options that its row names.

    plan : (n_vertices, 2) float64, x and y
    heights : (n_vertices, n_channels) float64, z and the weighted attributes
    faces : (n_faces, 3) int32
    locked : (n_vertices,) bool
    options : mapping, by the names in `PartitionRow.options`
    """

    plan: FloatArray
    heights: FloatArray
    faces: NDArray
    locked: NDArray
    options: Mapping[str, Any]


class PartitionRow(NamedTuple):
    """One partition: a row of :data:`PARTITIONS`.

    name : str, what `analyse` takes
    make : callable, from a PartitionInput to an orderings.Partition
    help : str, one line for lists
    equation : str, where the paper has it; empty for what is beyond the paper
    options : tuple of str, the parameters of `analyse` that it, and no other, looks at
    prediction : str, the filter that goes with it where none is named
    needs_upright : bool, whether every face must be counter-clockwise in plan
    """

    name: str
    make: Callable[[PartitionInput], orderings.Partition]
    help: str
    equation: str = ""
    options: tuple[str, ...] = ()
    prediction: str = "geometric"
    needs_upright: bool = False


def _surface(source: PartitionInput) -> orderings.Partition:
    level = SurfaceLevel(
        source.plan, source.heights, source.faces, source.locked, with_update=False
    )
    return orderings.SurfacePartition(level, **source.options)


#: The partitions. A new one is a class with `split` and `descend` and a row here, and no more: the
#: options, the help of the command line, the dialogs and the tests read the table.
PARTITIONS = Table(
    "partition",
    (
        PartitionRow(
            "surface", _surface,
            "those that raise the vertical errors at all input points least",
            options=("norm", "removal_fraction"),
            prediction="barycentric",
            needs_upright=True,
        ),
        PartitionRow(
            "quadric", lambda source: orderings.QuadricPartition(**source.options),
            "those of least cost by generalised quadrics and bending energy", "Algorithms 1 and 2",
            options=("bending_weight", "quadrics", "cost"),
        ),
        PartitionRow(
            "colouring", lambda source: orderings.ColouringPartition(),
            "in the order of their index, regardless of shape", "Fig. 8",
        ),
        PartitionRow(
            "random", lambda source: orderings.RandomPartition(**source.options),
            "in random order, for pyramids that are averaged",
            options=("seed",),
        ),
    ),
)  # fmt: skip


class Norm(NamedTuple):
    """What a surface-guided partition keeps small: a row of :data:`NORMS`.

    name : str, what `analyse` takes
    help : str, one line for lists
    update : str, the update that goes with it where none is named
    removal_fraction : float, share that a level may take, where none is given
    removal_fraction_to_size : float, the same where a number of vertices says when to stop
    """

    name: str
    help: str
    update: str
    removal_fraction: float
    removal_fraction_to_size: float


#: By what a surface-guided partition judges a removal.
NORMS = Table(
    "norm",
    (
        Norm(
            "rms", "the mean square of the vertical errors", "minimum_norm",
            REMOVAL_FRACTION, REMOVAL_FRACTION,
        ),
        Norm(
            "max", "the largest vertical error", "none",
            REMOVAL_FRACTION, MAX_NORM_REMOVAL_FRACTION,
        ),
    ),
)  # fmt: skip
