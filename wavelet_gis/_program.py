"""The program's name, and the names that follow from it; imports nothing."""

PROGRAM = "terrain-wavelets"

#: Begin of the names of the folders that outputs are written in before they appear.
SCRATCH_PREFIX = f".{PROGRAM}-"
