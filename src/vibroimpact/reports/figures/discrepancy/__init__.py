"""The figures of a discrepancy: where it is, what explains it, and a first look at a campaign."""
