"""Point clouds in memory: the points, those set aside, their mesh, and the way back from it."""
