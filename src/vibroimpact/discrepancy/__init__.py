"""Where simulation and measurement disagree, which effect is missing, and how far adding it closes
the gap.
"""
