"""Forces: random, measured or of a formula, and their places on the structure."""
