"""A tube in space: its centreline, directions across it, and the mesh along it."""
