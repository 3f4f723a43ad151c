"""What holds terrain, by kind: each opened by a function of its own."""
