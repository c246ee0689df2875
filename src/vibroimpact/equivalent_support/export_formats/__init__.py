"""Springs and dampers to ground, and the contact of the supports, in the input formats of other
programs, one module each.

A module has `springs_text(springs, unit, first_number)`, `contacts_text(contacts, unit,
first_number)` or both, which return the text of a file.
"""
