"""Where simulation and measurement disagree, which effect is missing, and how much of the
misfit adding it closes.
"""
