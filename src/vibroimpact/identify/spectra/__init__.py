"""Averaged spectra, what their window does, and records of whole periods line by line."""
