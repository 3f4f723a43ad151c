"""TINs as SELAFIN, the geometry file of TELEMAC: double precision, outline numbered."""

from __future__ import annotations

import os

import numpy as np

import wavelet_core
from wavelet_core import MissingDependencyError, TriangleMesh
from wavelet_gis.errors import OutputFileError
from wavelet_gis.io.formats import identifiers
from wavelet_gis.io.mesh.cad import metres_in_horizontal_unit
from wavelet_gis.io.read_back import read_back

__all__ = ["write_selafin"]

#: By which TELEMAC knows the elevation of the bed.
_BED = "BOTTOM"

#: Characters of a variable's name.
_NAME_LENGTH = 16


def write_selafin(path: str | os.PathLike[str], mesh: TriangleMesh, wkt: str | None = None) -> None:
    """Write a SELAFIN file of one time, with the bed and the attributes at its nodes.

    Parameters
    ----------
    path : path
    mesh : TriangleMesh
        In the coordinates to be written. Vertices that no face uses are left out.
    wkt : str, optional
        The CRS, whose unit becomes that of the bed if it is the metre. The format holds no CRS.

    Raises
    ------
    MissingDependencyError
        python-serafin is absent.
    OutputFileError
        No triangles, or an outline that meets itself at a node, which the format cannot number.

    Notes
    -----
    Written by python-serafin as ``SERAFIND``: all numbers have 64 bits, so that coordinates need
    no origin of their own. Names of attributes are cut to 13 characters and made ASCII.
    """
    try:
        import serafin
    except ImportError as error:
        raise MissingDependencyError(
            "SELAFIN is written by python-serafin, which is not installed; run 'pip install "
            "python-serafin'."
        ) from error
    if mesh.n_faces == 0:
        raise OutputFileError(f"{path}: there are no triangles, without which SELAFIN is no mesh.")
    used, corners = np.unique(mesh.faces, return_inverse=True)
    values = np.column_stack([mesh.vertices[used, 2], mesh.attributes[used]]).T
    header = serafin.SerafinHeader(
        f"terrain-wavelets {wavelet_core.__version__}", format_type="SERAFIND"
    )
    is_metre = abs(metres_in_horizontal_unit(wkt or "") - 1) < 1e-9
    units = ["M" if is_metre else "", *[""] * len(mesh.attribute_names)]
    names = (name[: _NAME_LENGTH - 3] for name in mesh.attribute_names)  # and _2 to _99
    for name, unit in zip(identifiers([_BED, *names]), units, strict=True):
        header.add_variable_str(name, name, unit)
    faces = corners.reshape(-1, 3).astype(np.int64) + 1
    outline = np.zeros(len(used), dtype=np.int64)
    header.from_triangulation(mesh.vertices[used, :2], faces, outline)
    try:
        header.build_ipobo(strict=True)
    except serafin.SerafinRequestError as error:
        raise OutputFileError(
            f"{path}: the outline meets itself at a node, which SELAFIN cannot number ({error}); "
            "leave out the triangles on one side, or write another format."
        ) from error
    with serafin.SerafinWriter(os.fspath(path), "en", overwrite=True) as file:
        file.write_header(header)
        file.write_entire_frame(header, 0.0, values)

    def check(written: str | os.PathLike[str]) -> None:
        with serafin.SerafinReader(os.fspath(written), "en") as file:
            file.read_header()
            file.get_time()
            there, found = file.header, file.read_vars_in_frame(0)
        same = np.array_equal(found, values, equal_nan=True) and all(
            np.array_equal(np.asarray(a), np.asarray(b))
            for a, b in (
                (there.x, header.x),
                (there.y, header.y),
                (there.ikle, header.ikle),
                (there.ipobo, header.ipobo),
            )
        )
        if not same:
            raise OutputFileError("its numbers differ from those written")

    read_back(path, check)
