"""The figures of the hidden-effect suite."""
