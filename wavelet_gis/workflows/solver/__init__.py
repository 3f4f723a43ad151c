"""TINs as meshes that solvers take: angles, edges and areas within bounds."""
