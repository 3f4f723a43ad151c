"""Coordinate reference systems: frames, units, look-up."""
