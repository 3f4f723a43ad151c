"""Arrays, faces and grids as few bytes, and back."""
