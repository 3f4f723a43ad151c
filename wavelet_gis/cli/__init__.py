"""The command line ``terrain-wavelets``: arguments, messages, progress on a terminal.

Nothing is imported here: `wavelet_gis.cli.__main__` has to see to interrupts before it imports.
"""
