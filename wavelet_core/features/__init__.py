"""What details show: spectra, signatures, shape."""
