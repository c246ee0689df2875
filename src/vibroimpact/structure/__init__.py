"""The linear structure without contact: a tube, masses and springs, or matrices."""
