"""The linear stage: modes, sensor delays and linear effects identified from the lowest record, and
whether the linear model fits it.
"""
