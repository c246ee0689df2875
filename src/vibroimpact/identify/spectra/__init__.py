"""Averaged spectra, the effect of their window, and records of whole periods line by line."""
