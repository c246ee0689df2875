"""A measured campaign as a model sees it: what of it can be compared, its signals, and the model
with its channels as sensors and its forces as drives.

Owns no hypothesis and no score. May import all that comes before the diagnosis, and nothing of the
diagnosis beside it.
"""
