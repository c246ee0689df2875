"""The linear structure: a tube, masses and springs, or matrices; `contact` holds its supports.

Imports the configuration and the geometry.
"""
