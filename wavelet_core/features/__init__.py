"""What details show: spectra, signatures, shape, landforms, maps by scale."""
