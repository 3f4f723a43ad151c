"""Files, CRS and units around the wavelet core: DEM and LAS in and out, the pyramid file, the CLI.

Nothing is imported here, so that a part needs no more than its own packages: all of `model` and
`products`, and of `io` what QGIS uses, run on numpy, scipy and sqlite3 alone.
"""
