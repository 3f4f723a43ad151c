"""What details tell: spectra, signatures, shape."""
