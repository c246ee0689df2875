"""Every claim of the paper, measured on the default study."""

from . import equivalence, poles, response, shapes

CURVE_CLAIMS = (
    poles.smooth_transition,
    poles.pole_methods,
    poles.limits,
    poles.apparent_damping,
    response.anti_resonances,
    shapes.rank,
    equivalence.three_stiffnesses,
    equivalence.gap_reduction,
    response.response_point,
    poles.widths,
    shapes.no_damping,
    shapes.phase,
    response.spread_peaks,
)


def all_claims(config, model, gaps, step_rows, mode_rows, quality):
    """Return a list of all Claims.

    config, model: of the default study.
    gaps: its StudyCurves at the largest and at the smallest gap.
    step_rows, mode_rows: runs with different steps and numbers of modes, of
    convergence.runs.run_rows.
    quality: rows of basis_quality.csv.
    """
    wide, tight = gaps
    claims = [claim(wide, model) for claim in CURVE_CLAIMS]
    return [
        *claims,
        shapes.node(tight, model),
        equivalence.five_points(config),
        equivalence.theories(config),
        equivalence.step(step_rows),
        equivalence.basis(mode_rows, quality),
    ]
