"""The figures of the validation."""

from vibroimpact.reports.figures.columns import COLUMNS

# Axis labels and display units per SI unit of the columns that these figures add.
COLUMNS.update(
    {
        "element_size": ("Element length / coarsest (-)", 1.0),
        "relative_change": ("Relative change of the frequency (-)", 1.0),
        "point_spacing": ("Spacing of the points / height (-)", 1.0),
        "point_change": ("Relative change (-)", 1.0),
        "from_layer": ("|first frequency / layer's - 1| (%)", 1e2),
        "omega_step": ("Angular frequency times step (-)", 1.0),
        "period_shift": ("Relative loss of frequency (-)", 1.0),
        "step_s": ("Step (µs)", 1e6),
        "energy_defect": ("Energy residual / input work (-)", 1.0),
        "statistic_number": ("Statistic (-)", 1.0),
        "statistic_difference": ("Difference from the finest (%)", 1e2),
        "nu_formula": ("Degrees of freedom by formula (-)", 1.0),
        "nu_measured": ("Degrees of freedom over records (-)", 1.0),
        "buffer_s": ("Buffer (s)", 1.0),
        "peak_level_dB": ("Expected level / true peak (dB)", 1.0),
        "damping_over_true": ("Half-power damping / true (-)", 1.0),
        "band_width_Hz": ("Width of the bands (Hz)", 1.0),
        "variance_multiple": ("Variance over seeds / Gaussian (-)", 1.0),
        "singular_value_ratio": ("Singular value / first (-)", 1.0),
        "quadrature_share": ("Quadrature part of the shape (%)", 1e2),
        "node_arc_length_m": ("Arc length of the node (m)", 1.0),
        "valley_height_dB": ("Valley above the linear one (dB)", 1.0),
        "step_of_order_s": ("Step (µs)", 1e6),
        "contact_time_error_s": ("RMS error of contact times (s)", 1.0),
        "law_number": ("Quantity (-)", 1.0),
        "law_ratio": ("Simulated / exact (-)", 1.0),
        "contact_time": ("Fraction of time in contact (-)", 1.0),
        "prediction_error_dB": ("Linear / non-linear (dB)", 1.0),
        "across_plane_m": ("Displacement across the plane (mm)", 1e3),
        "moment_s": ("Time (ms)", 1e3),
        "push_N": ("Contact force (N)", 1.0),
        "free_modes_to_Hz": ("Free modes kept to (kHz)", 1e-3),
        "bend_elements": ("Elements of the bend (-)", 1.0),
        "judged_difference": ("Relative difference from OpenSees (-)", 1.0),
    }
)
