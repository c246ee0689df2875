"""The equivalent linear structure: responses and poles with a bilateral support, and the family
over (k, c).
"""
