"""Pyramid files: a GeoPackage that holds a pyramid, its arrays in checked chunks of bytes."""
