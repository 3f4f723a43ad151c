"""Vector layers and tables of points: read, and written."""
