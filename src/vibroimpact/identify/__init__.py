"""The equivalent linear support of a response: stiffness k and damping c of a bilateral support."""
