"""Springs and dampers to ground in the input formats of other programs, one module each.

Every module has `text(springs, unit, first_number)`, which returns the text of a file.
"""
