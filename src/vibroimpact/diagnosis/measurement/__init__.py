"""A measured campaign as a model sees it: its comparable part, its signals, and the model with its
channels as sensors and its forces as drives.

Owns no hypothesis and no score. May import all that comes before the diagnosis, and nothing else of
the diagnosis.
"""
