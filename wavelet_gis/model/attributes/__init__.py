"""What the attributes of points mean: categories, heights above the ground."""
