"""Predict and update: one step, the pyramid, its linear map, and the analysis that builds it."""
