"""How far a surface may be off, by place: what says so, and what came out."""
