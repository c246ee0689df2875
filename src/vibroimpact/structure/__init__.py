"""The linear structure without contact: beam elements of a tube, masses and springs, or matrices
from files.
"""
