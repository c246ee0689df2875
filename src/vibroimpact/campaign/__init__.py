"""Measured campaigns: the file, its signals, its checks, and the import of raw measurements."""
