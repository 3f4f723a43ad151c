"""What a workflow was given: a terrain, or a pyramid."""

from __future__ import annotations

from typing import Protocol

from wavelet_core.errors import OptionError
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.terrain import Terrain

__all__ = ["HoldsPyramid", "pyramid_of", "require_terrain"]


class HoldsPyramid(Protocol):
    """A result that holds a pyramid, such as an `Analysis`."""

    @property
    def geo(self) -> GeoPyramid:
        """The pyramid."""


def pyramid_of(data: HoldsPyramid | GeoPyramid) -> GeoPyramid:
    """Return the pyramid that a workflow was given.

    Parameters
    ----------
    data : Analysis, Filtered or GeoPyramid
        What analysing, filtering or loading returned.

    Raises
    ------
    OptionError
        Something else.
    """
    geo = getattr(data, "geo", data)
    if isinstance(geo, GeoPyramid):
        return geo
    raise OptionError(
        f"a {type(data).__name__} is no pyramid; give what 'wavelet_gis.analyse' or "
        "'wavelet_gis.load' returns."
    )


def require_terrain(data: object) -> None:
    """Raise `OptionError` unless this is a terrain that can be analysed."""
    if not isinstance(data, Terrain):
        raise OptionError(
            f"a {type(data).__name__} is no terrain that can be analysed; give what "
            "'wavelet_gis.open' returns for a raster, a point cloud or a TIN."
        )
