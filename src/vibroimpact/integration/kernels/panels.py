"""Panels: ``PANEL`` consecutive modes, each a lane vector, held in registers.

Modes are padded with zeros to whole panels. Each function computes one line for m = 0 to PANEL - 1.

Of one run, a single hardware vector holds the panel. The order of all sums is the same, so that a
run has the same bits alone as in a batch.
"""

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, models, register_model

from .lanes import (
    DOUBLE,
    INT32,
    LANES,
    call_intrinsic,
    lane_vector,
    load_value,
    spread_element,
    store_value,
)

PANEL = 8

SPAN = PANEL if LANES == 1 else 1  # modes in one vector of a panel
WIDE = ir.VectorType(DOUBLE, SPAN * LANES)


class PanelVector(types.Type):
    """The numba type of SPAN modes of a panel."""

    def __init__(self) -> None:
        super().__init__(name="PanelVector")


@register_model(PanelVector)
class _PanelVectorModel(models.PrimitiveModel):
    def __init__(self, manager, numba_type):
        super().__init__(manager, numba_type, WIDE)


panel_type = types.UniTuple(PanelVector(), PANEL // SPAN)


def _plus(builder, index, step):
    return builder.add(index, ir.Constant(index.type, step))


def _vectors(builder, panel):
    return cgutils.unpack_tuple(builder, panel, PANEL // SPAN)


def _modes(builder, panel):
    """The panel as a lane vector for each mode."""
    if SPAN == 1:
        return _vectors(builder, panel)
    return [
        _picked(builder, vector, [m]) for vector in _vectors(builder, panel) for m in range(SPAN)
    ]


def _over_modes(builder, vector):
    """A lane vector repeated for every mode in a vector of a panel."""
    return vector if SPAN == 1 else _picked(builder, vector, [0] * SPAN)


def _picked(builder, vector, elements):
    chosen = ir.Constant(ir.VectorType(INT32, len(elements)), elements)
    return builder.shuffle_vector(vector, ir.Constant(vector.type, ir.Undefined), chosen)


def _mode_factors(context, builder, array_type, coefficients, j):
    """Coefficients j to j + PANEL - 1, each in every lane."""
    return [
        spread_element(context, builder, array_type, coefficients, _plus(builder, j, m))
        for m in range(PANEL)
    ]


def _factors(context, builder, array_type, coefficients, j):
    """Coefficients j to j + PANEL - 1 in the vectors of a panel, each in every lane."""
    if SPAN == 1:
        return _mode_factors(context, builder, array_type, coefficients, j)
    return [load_value(context, builder, array_type, coefficients, j, WIDE)]


@intrinsic
def load_panel(typing_context, array, i):
    """The PANEL vectors from vector i on."""

    def code(context, builder, sig, args):
        vectors = [
            load_value(context, builder, sig.args[0], args[0], _plus(builder, args[1], m), WIDE)
            for m in range(0, PANEL, SPAN)
        ]
        return context.make_tuple(builder, sig.return_type, vectors)

    return panel_type(array, types.intp), code


@intrinsic
def store_panel(typing_context, array, i, panel):
    """Write the PANEL vectors from vector i on."""

    def code(context, builder, sig, args):
        for m, vector in enumerate(_vectors(builder, args[2])):
            at = _plus(builder, args[1], SPAN * m)
            store_value(context, builder, sig.args[0], args[0], at, vector)
        return context.get_dummy_value()

    return types.void(array, types.intp, panel_type), code


@intrinsic
def panel_zero(typing_context):
    """A panel of zeros."""

    def code(context, builder, sig, args):
        zero = ir.Constant(WIDE, [0.0] * WIDE.count)
        return context.make_tuple(builder, sig.return_type, [zero] * (PANEL // SPAN))

    return panel_type(), code


@intrinsic
def panel_plus_vector(typing_context, coefficients, j, vector, panel):
    """panel[m] + coefficients[j + m] * vector: one row force spread over PANEL modes."""

    def code(context, builder, sig, args):
        factors = _factors(context, builder, sig.args[0], args[0], args[1])
        vector = _over_modes(builder, args[2])
        out = [
            call_intrinsic(builder, "fma", [factor, vector, term])
            for factor, term in zip(factors, _vectors(builder, args[3]), strict=True)
        ]
        return context.make_tuple(builder, sig.return_type, out)

    return panel_type(coefficients, types.intp, lane_vector, panel_type), code


@intrinsic
def panel_plus_scaled(typing_context, coefficients, j, a, panel):
    """panel[m] + coefficients[j + m] * a[m]: one coefficient per mode."""

    def code(context, builder, sig, args):
        factors = _factors(context, builder, sig.args[0], args[0], args[1])
        a, panel = (_vectors(builder, arg) for arg in args[2:])
        out = [
            call_intrinsic(builder, "fma", terms) for terms in zip(factors, a, panel, strict=True)
        ]
        return context.make_tuple(builder, sig.return_type, out)

    return panel_type(coefficients, types.intp, panel_type, panel_type), code


@intrinsic
def panel_plus_common(typing_context, vector, a, panel):
    """panel[m] + vector * a[m]: one factor for all modes."""

    def code(context, builder, sig, args):
        vector = _over_modes(builder, args[0])
        a, panel = (_vectors(builder, arg) for arg in args[1:])
        out = [
            call_intrinsic(builder, "fma", [vector, *terms]) for terms in zip(a, panel, strict=True)
        ]
        return context.make_tuple(builder, sig.return_type, out)

    return panel_type(lane_vector, panel_type, panel_type), code


def _each_mode(instruction):
    """Signature and code of an instruction with two arguments, mode by mode."""

    def code(context, builder, sig, args):
        a, b = (_vectors(builder, arg) for arg in args)
        out = [getattr(builder, instruction)(*terms) for terms in zip(a, b, strict=True)]
        return context.make_tuple(builder, sig.return_type, out)

    return panel_type(panel_type, panel_type), code


@intrinsic
def panel_product(typing_context, a, b):
    """a[m] * b[m]."""
    return _each_mode("fmul")


@intrinsic
def panel_sum(typing_context, a, b):
    """a[m] + b[m]."""
    return _each_mode("fadd")


@intrinsic
def panel_difference(typing_context, a, b):
    """a[m] - b[m]."""
    return _each_mode("fsub")


@intrinsic
def vector_plus_dot(typing_context, coefficients, j, panel, vector):
    """vector + sum over m of coefficients[j + m] * panel[m]: PANEL modes projected on one row."""

    def code(context, builder, sig, args):
        terms = _modes(builder, args[2])
        factors = _mode_factors(context, builder, sig.args[0], args[0], args[1])
        # Even and odd modes in two sums, which halves the latency.
        even, odd = args[3], builder.fmul(factors[1], terms[1])
        for m in range(0, PANEL, 2):
            even = call_intrinsic(builder, "fma", [factors[m], terms[m], even])
            if m > 0:
                odd = call_intrinsic(builder, "fma", [factors[m + 1], terms[m + 1], odd])
        return builder.fadd(even, odd)

    return lane_vector(coefficients, types.intp, panel_type, lane_vector), code
