"""The commands of ``terrain-wavelets``, one module each; see `wavelet_gis.cli.main`."""
