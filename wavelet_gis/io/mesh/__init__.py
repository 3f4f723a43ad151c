"""TINs as mesh files."""
