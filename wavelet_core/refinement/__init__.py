"""Less error with as many vertices: places, edges and heights of a coarse TIN, improved in rounds."""
