"""Where a tube runs in space: its centreline, directions across it, and the mesh along it."""
