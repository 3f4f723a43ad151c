"""A TIN: vertices, faces, one-rings, legal collapses, curvature, quadrics, point location."""
