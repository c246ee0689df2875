"""The figures of a discrepancy: its place, its explanation, and a first look at a campaign."""
