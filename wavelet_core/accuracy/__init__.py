"""Measured errors, fitted heights, meshes of sizes between the levels."""
