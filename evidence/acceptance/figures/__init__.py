"""The figures of the acceptance of verdicts."""
