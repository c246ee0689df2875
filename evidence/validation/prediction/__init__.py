"""Predictions by the equivalent linear tube where it was not fitted."""
