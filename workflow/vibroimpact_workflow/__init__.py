"""Snakemake's files, logs, locks and options: the rules share it, the library does not know it."""
