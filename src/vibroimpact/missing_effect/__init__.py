"""Names the effect that a model lacks, with a probability for every explanation."""
