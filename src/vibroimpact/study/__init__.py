"""The study: cases over load, gap and seed, their simulation, and whether the methods agree on the
equivalent support.
"""
