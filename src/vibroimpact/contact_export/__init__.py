"""The contact of the supports in the input formats of other programs, one module each.

Every format has `text(contacts, unit, first_number)`, which returns the text of a file, and reasons
to leave something out. It imports the reduced model and what exported springs share with it.
"""
