"""Parts of a simplification: what is asked for, what comes out, the points that carry it."""
