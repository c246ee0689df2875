"""What the project costs beside what a user would otherwise pick: `make benchmark`, or `python -m
evidence.benchmarks --help`.
"""
