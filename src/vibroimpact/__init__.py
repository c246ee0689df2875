"""vibroimpact: tubes that rattle in their supports, and the linear support that is equivalent to
them.
"""

__version__ = "0.1.0"
