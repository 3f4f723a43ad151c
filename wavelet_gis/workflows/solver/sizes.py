"""How long edges of a mesh for a solver may be, from what a user says by place."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core.errors import OptionError
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.workflows.solver.solver_mesh import SolverRules, edge_of_area
from wavelet_gis.workflows.tolerance.by_place import ByPlace, MaxError, is_number, values_by_place

__all__ = ["Sizes", "rules_of"]

FloatArray = NDArray[np.float64]

#: Field of the zones that holds the longest edge, where none is named.
SIZE_FIELD = "longest_edge"


class Sizes(NamedTuple):
    """Longest edges and largest areas, each a number or what gives one by place.

    longest_edge, max_area : float, path, str, array_like or callable, optional
        As ``max_error`` of `wavelet_gis.workflows.tolerance.by_place.tolerances`, in the unit of
        the working frame; any where nothing says it.
    zones : path or GeoDataFrame, optional
        Polygons with sizes of their own; where several overlap the least counts, and the others
        hold outside.
    field, area_field : str, optional
        Fields of the zones with the longest edge, ``longest_edge`` unless one of the two is named,
        and with the largest area.
    """

    longest_edge: MaxError | None = None
    max_area: MaxError | None = None
    zones: Any = None
    field: str | None = None
    area_field: str | None = None

    def at_vertices(self, terrain: Terrain) -> FloatArray | None:
        """Return the longest edge by place at each vertex of a terrain, infinite for any.

        Returns
        -------
        (n_vertices,) float64 or None
            None where all sizes are numbers.

        Raises
        ------
        InputFileError
            A file that cannot be read, or that has no size for any vertex.
        OptionError
            A formula that is none, numbers of another length, or a size that is not above 0.
        """
        edges = self._values(terrain, "longest_edge", self.edge_field, "size_field")
        areas = self._values(terrain, "max_area", self.area_field, "area_field")
        if areas is not None:
            of_areas = edge_of_area(areas)
            edges = of_areas if edges is None else np.minimum(edges, of_areas)
        return edges

    @property
    def edge_field(self) -> str | None:
        """The field of the zones that holds the longest edge, where one does."""
        if self.zones is None or (self.field is None and self.area_field is not None):
            return None
        return self.field or SIZE_FIELD

    def _values(
        self, terrain: Terrain, name: str, field: str | None, field_option: str
    ) -> FloatArray | None:
        given = getattr(self, name)
        if field is None and (given is None or is_number(given)):
            return None
        zones = None if field is None else self.zones
        options = ByPlace(name, "size_zones", field_option)
        values = values_by_place(terrain, terrain.mesh, given, zones, field or "", options)
        values = np.where(np.isnan(values), np.inf, values)
        if not (values > 0).all():
            raise OptionError(
                "{0} is not above 0 at {n} input points, down to {least:.4g}; give sizes above 0.",
                name,
                n=int((values <= 0).sum()),
                least=float(values.min()),
            )
        return values


def rules_of(
    min_angle: float = 25.0,
    longest_edge: MaxError | None = None,
    shortest_edge: float | None = None,
    max_area: MaxError | None = None,
    size_zones: Any = None,
    size_field: str | None = None,
    area_field: str | None = None,
    grading: float | None = None,
) -> SolverRules:
    """Return all rules of `Simplified.for_solver`, with those sizes that are numbers.

    Raises
    ------
    OptionError
        A field without zones.
    """
    for name, field in (("size_field", size_field), ("area_field", area_field)):
        if field is not None and size_zones is None:
            raise OptionError("{0} goes with {1}; give both or neither.", name, "size_zones")
    sizes = Sizes(longest_edge, max_area, size_zones, size_field, area_field)
    return SolverRules(
        min_angle,
        None if sizes.edge_field is not None else _number(longest_edge),
        shortest_edge,
        None if area_field is not None else _number(max_area),
        grading,
    )


def _number(given: MaxError | None) -> float | None:
    return float(given) if is_number(given) else None  # type: ignore[arg-type]
