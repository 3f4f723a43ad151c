"""Files: rasters, LAS, vectors, meshes, CAD, GeoPackage, the pyramid file; whole or not at all."""
