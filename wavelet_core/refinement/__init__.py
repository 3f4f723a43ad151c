"""Coarse TINs bettered in rounds: places, edges and heights, with as many vertices."""
