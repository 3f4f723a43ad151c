"""Tiled terrain for globes: quantized-mesh, one TIN for each tile and zoom."""
