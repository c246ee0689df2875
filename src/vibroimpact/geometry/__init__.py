"""Where a tube runs in space: its centreline, the mesh on it, and directions across it."""
