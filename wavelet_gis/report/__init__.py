"""The quality report: numbers, pictures, page."""
