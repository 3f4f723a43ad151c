"""What a dialog asks, and the way back into options and outputs."""
