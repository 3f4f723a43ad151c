"""Labels of vertices: clusters of alike scales, and classes learned from those that have one."""
