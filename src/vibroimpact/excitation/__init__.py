"""Forces: random, measured or of a formula, and where on the structure they act."""
