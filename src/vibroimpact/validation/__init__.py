"""Verification and validation: our results beside closed forms, published numbers, other codes and
the paper's claims.
"""
