"""Which options of reading have a meaning for which kind of input."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from wavelet_gis.crs.frame import CoordinateSystem
from wavelet_gis.errors import InputFileError

__all__ = [
    "CLOUD",
    "POINTS",
    "PYRAMID",
    "RASTER",
    "TABLE",
    "TRIANGLES",
    "require_meaning",
    "system_given",
]

RASTER, CLOUD, POINTS, TABLE, TRIANGLES, PYRAMID = (
    "a raster",
    "a point cloud",
    "a layer of points",
    "a table of points",
    "a layer of triangles",
    "a pyramid",
)

#: Of these a TIN is made; one that is a TIN already has its edges.
_NO_TIN = (RASTER, CLOUD, POINTS, TABLE)

#: For which kinds of input an option is. The others hold for every input, or of themselves.
_MEANT_FOR = {
    "band": (RASTER,),
    "nodata": (RASTER,),
    "attributes": (CLOUD, POINTS, TABLE),
    "classes": (CLOUD,),
    "class_channels": (CLOUD,),
    "carry": (CLOUD,),
    "keep_noise": (CLOUD,),
    "keep_withheld": (CLOUD,),
    "duplicates": (CLOUD,),
    "max_edge": (CLOUD,),
    "concave": (CLOUD,),
    "bbox": (CLOUD,),
    "resolution": (CLOUD,),
    "layer": (POINTS, TRIANGLES),
    "z_field": (POINTS,),
    "breaklines": _NO_TIN,
    "clip": _NO_TIN,
    "fixed_points": _NO_TIN,
    "line_tolerance": _NO_TIN,
}


def require_meaning(path: object, kind: str, options: Mapping[str, Any]) -> None:
    """Refuse options that would be ignored.

    Parameters
    ----------
    path : path or str
        Of the input, for the message.
    kind : str
        What it is, one of the kinds named in this module.
    options : mapping of str to value
        As given; names that are for every kind of input are passed over.

    Raises
    ------
    InputFileError
        An option that this kind of input does not have.
    """
    in_vain = [
        name
        for name, kinds in _MEANT_FOR.items()
        if kind not in kinds and _is_given(name, options.get(name))
    ]
    if in_vain:
        names = [f"{{{k}}}" for k in range(len(in_vain))]
        listed = " and ".join([", ".join(names[:-1]), names[-1]]) if names[1:] else names[0]
        verb, pronoun = ("are", "them") if names[1:] else ("is", "it")
        others = " or ".join(_MEANT_FOR[in_vain[0]])
        raise InputFileError(
            f"{{path}}: this is {{kind}}, and {listed} {verb} for {{others}}; leave {pronoun} out.",
            *in_vain,
            path=path,
            kind=kind,
            others=others,
        )


def _is_given(name: str, value: Any) -> bool:
    if name == "carry":  # the one that is on by default
        return value is False
    if value is None or value is False:
        return False
    if name == "attributes":
        return len(value) > 0
    return True


def system_given(crs: str | None) -> CoordinateSystem | None:
    """Return the coordinate system that an option names, to be taken instead of the input's.

    Parameters
    ----------
    crs : str, optional
        As a user writes it.
    """
    if not crs:
        return None
    from wavelet_gis.crs.lookup import coordinate_system

    return coordinate_system(crs)
