"""The configuration of a study: its declaration, its checks, its JSON schema and key reference, and
the part of it that each stage of the workflow gets.

Config is the declaration, checked and immutable. StageSettings is the view of it that a stage gets,
with the same attribute names. `materials` holds the properties of named metals and fluids.
"""
