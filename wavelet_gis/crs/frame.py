"""Coordinate systems in numbers: the working frame that geometry is computed in, and units.

Nothing here reads a CRS definition; `wavelet_gis.crs.lookup` does that with pyproj, and QGIS can
fill a `CoordinateSystem` from its own CRS object.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from wavelet_gis._fields import Fields
from wavelet_gis.errors import CrsError

__all__ = [
    "MAX_DISTORTION",
    "MAX_SPAN_DEGREES",
    "UNIT_OF_X_AND_Y",
    "CoordinateSystem",
    "Georeference",
    "LocalFrame",
    "assumed_vertical_unit",
    "metres_per_degree",
    "vertical_unit_name",
    "working_frame",
]

#: Largest relative error of the metres per degree of longitude that a frame may have anywhere.
#: Our choice: 5 %, the error over 5.7 degrees of latitude at 45 degrees, 20 m in 400 m of slope.
MAX_DISTORTION = 0.05

#: Spans beyond this are not local whatever the distortion (near the equator it grows slowly).
MAX_SPAN_DEGREES = 20.0

#: Metres in one vertical unit, by the names used in files and messages.
VERTICAL_UNITS = {"metre": 1.0, "foot": 0.3048, "us_survey_foot": 1200.0 / 3937.0}

#: Said of z where nobody knows the unit of x and y.
UNIT_OF_X_AND_Y = "unit of x and y"

_UNIT_ALIASES = {
    "m": "metre",
    "meter": "metre",
    "meters": "metre",
    "metres": "metre",
    "ft": "foot",
    "feet": "foot",
    "international foot": "foot",
    "us-ft": "us_survey_foot",
    "ftus": "us_survey_foot",
    "us survey foot": "us_survey_foot",
    "us survey feet": "us_survey_foot",
    "us-survey-foot": "us_survey_foot",
    "foot_us": "us_survey_foot",
}

Kind = Literal["geographic", "projected", "unknown"]


@dataclass(frozen=True, slots=True)
class CoordinateSystem:
    """What is known of a CRS, in numbers.

    Attributes
    ----------
    wkt : str or None
        Its definition, kept as it came so that it can be given back; None without a CRS.
    name : str
        For messages.
    kind : {"geographic", "projected", "unknown"}
        "unknown" stands for no CRS, a local one, and any other whose x and y are no map plane.
    horizontal_unit : float
        Radians in one unit of x and y when geographic, else metres (1 where unknown).
    vertical_unit : str or None
        Name of the unit of z where the CRS states one.
    semi_major, inverse_flattening : float
        The ellipsoid; the inverse flattening of a sphere is 0.
    """

    wkt: str | None = None
    name: str = "no CRS"
    kind: Kind = "unknown"
    horizontal_unit: float = 1.0
    vertical_unit: str | None = None
    semi_major: float = 6378137.0
    inverse_flattening: float = 298.257223563

    @property
    def working_unit(self) -> float:
        """Metres in one unit of the working frame, of z too: those of a geographic CRS are metres.

        1 where the unit is not known.
        """
        return 1.0 if self.kind == "geographic" else self.horizontal_unit

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as JSON-able values."""
        return asdict(self)

    @classmethod
    def from_dict(cls, fields: dict[str, Any]) -> CoordinateSystem:
        """Return the system that `to_dict` described.

        Raises
        ------
        CrsError
            When a field is missing, of another type or not finite.
        """
        stored = Fields(fields, "the CRS", CrsError)
        unit = stored.text_or_none("vertical_unit")
        return cls(
            wkt=stored.text_or_none("wkt"),
            name=stored.text("name"),
            kind=stored.choice("kind", get_args(Kind)),  # type: ignore[arg-type]
            horizontal_unit=stored.number("horizontal_unit"),
            vertical_unit=None if unit is None else vertical_unit_name(unit),
            semi_major=stored.number("semi_major"),
            inverse_flattening=stored.number("inverse_flattening"),
        )


class Georeference(NamedTuple):
    """What a file says of its coordinates.

    wkt : str or None
        Of the CRS.
    vertical_unit : str or None
        Name of the unit of z where the file gives it outside the CRS.
    fault : str
        What is wrong with the file's CRS, where it has one that cannot be used.
    notes : tuple of str
        What is odd about it where it can be used.
    """

    wkt: str | None = None
    vertical_unit: str | None = None
    fault: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class LocalFrame:
    """The affine map between a file's coordinates and the ones that geometry is computed in.

    ``x_local = (x - x_origin) * x_scale``, the same for y, and ``z_local = z * z_scale``. In the
    working frame x, y and z are in one length unit. For a projected CRS the map is the identity,
    but for z where its unit differs.

    Attributes
    ----------
    x_origin, y_origin : float
        In the file's units.
    x_scale, y_scale, z_scale : float
        Working units in one unit of the file.
    """

    x_origin: float = 0.0
    y_origin: float = 0.0
    x_scale: float = 1.0
    y_scale: float = 1.0
    z_scale: float = 1.0

    @property
    def is_identity(self) -> bool:
        """Whether the file's coordinates are worked on as they stand."""
        return self == LocalFrame()

    def local_x(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return x in the working frame."""
        return x if self._keeps_x else (x - self.x_origin) * self.x_scale

    def local_y(self, y: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return y in the working frame."""
        return y if self._keeps_y else (y - self.y_origin) * self.y_scale

    def file_x(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return x of the working frame in the file's coordinates."""
        return x if self._keeps_x else x / self.x_scale + self.x_origin

    def file_y(self, y: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return y of the working frame in the file's coordinates."""
        return y if self._keeps_y else y / self.y_scale + self.y_origin

    def local_z(self, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return z in the working unit."""
        return z if self.z_scale == 1.0 else z * self.z_scale

    def file_z(self, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return z of the working frame in the file's vertical unit."""
        return z if self.z_scale == 1.0 else z / self.z_scale

    def to_local(self, coordinates: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ``(n, 3)`` coordinates of the file in the working frame."""
        x, y, z = coordinates.T
        return np.column_stack([self.local_x(x), self.local_y(y), self.local_z(z)])

    def to_file(self, coordinates: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ``(n, 3)`` coordinates of the working frame in the file's coordinates."""
        if self.is_identity:
            return coordinates
        x, y, z = coordinates.T
        return np.column_stack([self.file_x(x), self.file_y(y), self.file_z(z)])

    @property
    def _keeps_x(self) -> bool:
        return self.x_origin == 0.0 and self.x_scale == 1.0

    @property
    def _keeps_y(self) -> bool:
        return self.y_origin == 0.0 and self.y_scale == 1.0

    def to_dict(self) -> dict[str, float]:
        """Return the fields as JSON-able values."""
        return asdict(self)

    @classmethod
    def from_dict(cls, fields: dict[str, Any]) -> LocalFrame:
        """Return the frame that `to_dict` described.

        Raises
        ------
        CrsError
            When a field is missing, no number, or a scale is not positive and finite.
        """
        stored = Fields(fields, "the working frame", CrsError)
        if unknown := stored.keys() - asdict(cls()).keys():
            raise stored.fault(f"{min(unknown)} is no part of one")
        frame = cls(**{name: stored.number(name) for name in asdict(cls())})
        if min(frame.x_scale, frame.y_scale, frame.z_scale) <= 0:
            raise CrsError("the stored frame has a scale that is no length; write the file anew.")
        return frame


def working_frame(
    system: CoordinateSystem,
    bounds: tuple[float, float, float, float],
    vertical_unit: str | None = None,
) -> LocalFrame:
    """Return the frame in which geometry over `bounds` is computed.

    Parameters
    ----------
    system : CoordinateSystem
        The CRS of the file.
    bounds : (x_min, y_min, x_max, y_max)
        Of the data, in the file's coordinates.
    vertical_unit : str, optional
        Unit of z; by default the CRS's, and where it has none, that of `assumed_vertical_unit`.

    Returns
    -------
    LocalFrame
        In metres for a geographic CRS, else in the unit of x and y.

    Raises
    ------
    CrsError
        Geographic bounds that are no degrees, or that span more than one frame can serve.

    Notes
    -----
    A degree of latitude is ``M pi / 180`` metres and one of longitude ``N cos(phi) pi / 180``,
    with M and N the ellipsoid's radii of curvature at the latitude phi of the centre.

    Examples
    --------
    >>> from wavelet_gis.crs.frame import CoordinateSystem, working_frame
    >>> import math
    >>> wgs84 = CoordinateSystem(kind="geographic", horizontal_unit=math.pi / 180)
    >>> frame = working_frame(wgs84, (7.0, 43.0, 8.0, 44.0))
    >>> round(frame.x_scale), round(frame.y_scale)
    (80877, 111102)
    """
    unit = vertical_unit_name(vertical_unit) if vertical_unit else system.vertical_unit
    if system.kind != "geographic":
        if unit is None and assumed_vertical_unit(system) != UNIT_OF_X_AND_Y:
            unit = assumed_vertical_unit(system)
        metres = VERTICAL_UNITS[unit] if unit and system.kind == "projected" else None
        z_scale = 1.0 if metres is None else metres / system.horizontal_unit
        return LocalFrame(z_scale=1.0 if abs(z_scale - 1.0) < 1e-12 else z_scale)
    degrees = np.array(bounds) * math.degrees(system.horizontal_unit)
    _check_span(degrees)
    x_min, y_min, x_max, y_max = bounds
    x_centre, y_centre = (x_min + x_max) / 2, (y_min + y_max) / 2
    east, north = metres_per_degree(math.degrees(y_centre * system.horizontal_unit), system)
    return LocalFrame(
        x_origin=x_centre,
        y_origin=y_centre,
        x_scale=east * math.degrees(system.horizontal_unit),
        y_scale=north * math.degrees(system.horizontal_unit),
        z_scale=VERTICAL_UNITS[unit or "metre"],
    )


def assumed_vertical_unit(system: CoordinateSystem) -> str:
    """Return the unit of z where nothing gives it.

    Parameters
    ----------
    system : CoordinateSystem
        Of x and y.

    Returns
    -------
    str
        The unit of x and y where that is the metre or a foot; the metre for degrees, and for
        kilometres and all else in which nobody measures heights; `UNIT_OF_X_AND_Y` without a map
        plane.
    """
    if system.kind == "unknown":
        return UNIT_OF_X_AND_Y
    if system.kind == "projected":
        for name, metres in VERTICAL_UNITS.items():
            if abs(system.horizontal_unit / metres - 1.0) < 2e-7:
                return name
    return "metre"


def metres_per_degree(latitude: float, system: CoordinateSystem) -> tuple[float, float]:
    """Metres in a degree of longitude and in one of latitude, on the system's ellipsoid.

    Parameters
    ----------
    latitude : float
        In degrees.
    system : CoordinateSystem
        Gives the ellipsoid.
    """
    flattening = 1 / system.inverse_flattening if system.inverse_flattening else 0.0
    eccentricity_squared = flattening * (2 - flattening)
    sine = math.sin(math.radians(latitude))
    root = math.sqrt(1 - eccentricity_squared * sine**2)
    normal_radius = system.semi_major / root
    meridian_radius = system.semi_major * (1 - eccentricity_squared) / root**3
    east = math.radians(1) * normal_radius * math.cos(math.radians(latitude))
    return east, math.radians(1) * meridian_radius


def vertical_unit_name(text: str) -> str:
    """Return the unit's name as this package writes it.

    Raises
    ------
    CrsError
        When the unit is not known.

    Examples
    --------
    >>> vertical_unit_name("US survey foot"), vertical_unit_name("m")
    ('us_survey_foot', 'metre')
    """
    lowered = text.strip().lower()
    name = _UNIT_ALIASES.get(lowered, lowered)
    if name not in VERTICAL_UNITS:
        raise CrsError(
            f"the vertical unit {text!r} is not known; use one of {', '.join(VERTICAL_UNITS)}."
        )
    return name


def _check_span(degrees: NDArray[np.float64]) -> None:
    west, south, east, north = (float(value) for value in degrees)
    if not all(math.isfinite(value) for value in (west, south, east, north)):
        raise CrsError("the extent is not finite; check the georeference of the input.")
    if max(abs(south), abs(north)) > 90.0 + 1e-6 or max(abs(west), abs(east)) > 540.0:
        raise CrsError(
            "the CRS is geographic but x runs from {west:g} to {east:g} and y from {south:g} to "
            "{north:g}, which are not degrees; give the right CRS with {0}.",
            "crs",
            west=west,
            east=east,
            south=south,
            north=north,
        )
    if east - west > 180.0:
        raise CrsError(
            f"x runs from {west:g} to {east:g} degrees: the data lie on both sides of the "
            "antimeridian, or around the earth; add 360 to the negative longitudes, reproject the "
            "input to a projected CRS, or cut it."
        )
    distortion = _distortion(south, north)
    span = max(east - west, north - south)
    if distortion > MAX_DISTORTION or span > MAX_SPAN_DEGREES:
        raise CrsError(
            f"the input spans {east - west:.3g} by {north - south:.3g} degrees up to latitude "
            f"{max(abs(south), abs(north)):.3g}, where one local metric frame would be wrong by "
            f"{min(distortion, 9.99):.0%}; reproject it to a projected CRS first, or cut it."
        )


def _distortion(south: float, north: float) -> float:
    """Largest relative error, over the latitudes, of the metres per degree of longitude."""
    middle = math.cos(math.radians((south + north) / 2))
    flattest = 0.0 if south < 0 < north else min(abs(south), abs(north))
    widest = math.cos(math.radians(flattest))
    narrowest = max(math.cos(math.radians(max(abs(south), abs(north)))), 1e-12)
    return max(widest / middle - 1, middle / narrowest - 1)
