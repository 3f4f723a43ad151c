"""Files, CRS and units around the wavelet core: DEM and LAS in and out, the pyramid file, the CLI.

Nothing is imported here, so that a part needs no more than its own packages: `crs`, `dem`,
`points`, `point_source`, `ledger`, `array_codec`, `geopackage`, `record`, `pyramid_file`, `layers`,
`styles`, `wkb`, `rasterise` and `meshfiles` run on numpy, scipy and sqlite3 alone.
"""
