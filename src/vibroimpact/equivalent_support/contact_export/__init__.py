"""The contact of the supports in the input formats of other programs, one module each.

Every module has `text(contacts, unit, first_number)`, which returns the text of a file.
"""
