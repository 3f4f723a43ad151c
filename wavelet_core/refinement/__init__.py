"""Coarse TINs improved in rounds: places, edges and heights, with as many vertices."""
