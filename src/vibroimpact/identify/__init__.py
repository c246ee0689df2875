"""Identification of an equivalent linear support: features of a response -> stiffness k and damping
c of a bilateral support.
"""
