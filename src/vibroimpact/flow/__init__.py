"""Fluid-elastic stability of a tube in a cross flow: critical velocities of its modes with the
supports that hold it, and eigenvalues with a fluid-elastic force.

It owns the criteria, the integrals along the tube and the coupled eigenvalues. It imports the
configuration, the geometry, the structure, the reduction and the linear structure; nothing that
simulates.
"""
