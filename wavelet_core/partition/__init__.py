"""Odd or even: which vertices go at a level, and onto which neighbour."""
