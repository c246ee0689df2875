"""The figures of the acceptance of verdicts."""

from vibroimpact.reports.figures.columns import COLUMNS

# Axis labels and display units per SI unit of the columns that these figures add.
COLUMNS.update(
    {
        "rate": ("Share of campaigns (%)", 1e2),
        "stated_probability": ("Probability stated (-)", 1.0),
        "true_share": ("Share that is true (-)", 1.0),
        "estimate_over_truth": ("Estimate / truth (-)", 1.0),
        "found": ("Truth in the set (%)", 1e2),
        "strength_over_floor": (
            "Strength: misfit of the bare model beyond its floor, held-out records (floors)",
            1.0,
        ),
    }
)
