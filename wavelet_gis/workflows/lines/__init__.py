"""Breaklines, a clip polygon and fixed points in a terrain."""
