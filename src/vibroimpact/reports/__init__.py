"""Reports as single pages: a discrepancy, the hidden-effect suite, the validation."""
