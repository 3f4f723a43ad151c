"""What is done to details: gains, thresholds, denoising."""
