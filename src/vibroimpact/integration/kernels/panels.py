"""Panels: ``PANEL`` consecutive modes, each a lane vector, in whose order every sum is taken.

Modes are padded with zeros to whole panels. A *tile* is as much of a panel as the registers hold
while rows are added to it: ``TILE`` modes. Each function of tiles computes one line for m = 0 to
TILE - 1. A projection keeps ``ROWS`` sums in registers instead and reads the modes from memory.

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
    REGISTER_LANES,
    VECTOR,
    call_intrinsic,
    lane_vector,
    load_value,
    spread_element,
    store_value,
)

PANEL = 8
TILE = PANEL if LANES <= REGISTER_LANES else PANEL // 2
ROWS = TILE // 2

SPAN = TILE if LANES == 1 else 1  # modes in one vector of a tile
WIDE = ir.VectorType(DOUBLE, SPAN * LANES)


class TileVector(types.Type):
    """The numba type of SPAN modes of a tile."""

    def __init__(self) -> None:
        super().__init__(name="TileVector")


@register_model(TileVector)
class _TileVectorModel(models.PrimitiveModel):
    def __init__(self, manager, numba_type):
        super().__init__(manager, numba_type, WIDE)


tile_type = types.UniTuple(TileVector(), TILE // SPAN)


def _plus(builder, index, step):
    return builder.add(index, ir.Constant(index.type, step))


def _vectors(builder, tile):
    return cgutils.unpack_tuple(builder, tile, TILE // SPAN)


def _modes(builder, tile):
    """The tile as a lane vector for each mode."""
    if SPAN == 1:
        return _vectors(builder, tile)
    return [
        _picked(builder, vector, [m]) for vector in _vectors(builder, tile) for m in range(SPAN)
    ]


def _over_modes(builder, vector):
    """A lane vector repeated for every mode in a vector of a tile."""
    return vector if SPAN == 1 else _picked(builder, vector, [0] * SPAN)


def _picked(builder, vector, elements):
    chosen = ir.Constant(ir.VectorType(INT32, len(elements)), elements)
    return builder.shuffle_vector(vector, ir.Constant(vector.type, ir.Undefined), chosen)


def _mode_factors(context, builder, array_type, coefficients, j):
    """Coefficients j to j + TILE - 1, each in every lane."""
    return [
        spread_element(context, builder, array_type, coefficients, _plus(builder, j, m))
        for m in range(TILE)
    ]


def _factors(context, builder, array_type, coefficients, j):
    """Coefficients j to j + TILE - 1 in the vectors of a tile, each in every lane."""
    if SPAN == 1:
        return _mode_factors(context, builder, array_type, coefficients, j)
    return [load_value(context, builder, array_type, coefficients, j, WIDE)]


@intrinsic
def load_tile(typing_context, array, i):
    """The TILE vectors from vector i on."""

    def code(context, builder, sig, args):
        vectors = [
            load_value(context, builder, sig.args[0], args[0], _plus(builder, args[1], m), WIDE)
            for m in range(0, TILE, SPAN)
        ]
        return context.make_tuple(builder, sig.return_type, vectors)

    return tile_type(array, types.intp), code


@intrinsic
def store_tile(typing_context, array, i, tile):
    """Write the TILE vectors from vector i on."""

    def code(context, builder, sig, args):
        for m, vector in enumerate(_vectors(builder, args[2])):
            at = _plus(builder, args[1], SPAN * m)
            store_value(context, builder, sig.args[0], args[0], at, vector)
        return context.get_dummy_value()

    return types.void(array, types.intp, tile_type), code


@intrinsic
def tile_zero(typing_context):
    """A tile of zeros."""

    def code(context, builder, sig, args):
        zero = ir.Constant(WIDE, [0.0] * WIDE.count)
        return context.make_tuple(builder, sig.return_type, [zero] * (TILE // SPAN))

    return tile_type(), code


@intrinsic
def tile_plus_vector(typing_context, coefficients, j, vector, tile):
    """tile[m] + coefficients[j + m] * vector: one row force spread over the modes."""

    def code(context, builder, sig, args):
        factors = _factors(context, builder, sig.args[0], args[0], args[1])
        vector = _over_modes(builder, args[2])
        out = [
            call_intrinsic(builder, "fma", [factor, vector, term])
            for factor, term in zip(factors, _vectors(builder, args[3]), strict=True)
        ]
        return context.make_tuple(builder, sig.return_type, out)

    return tile_type(coefficients, types.intp, lane_vector, tile_type), code


@intrinsic
def tile_plus_scaled(typing_context, coefficients, j, a, tile):
    """tile[m] + coefficients[j + m] * a[m]: one coefficient per mode."""

    def code(context, builder, sig, args):
        factors = _factors(context, builder, sig.args[0], args[0], args[1])
        a, tile = (_vectors(builder, arg) for arg in args[2:])
        out = [
            call_intrinsic(builder, "fma", terms) for terms in zip(factors, a, tile, strict=True)
        ]
        return context.make_tuple(builder, sig.return_type, out)

    return tile_type(coefficients, types.intp, tile_type, tile_type), code


@intrinsic
def tile_plus_common(typing_context, vector, a, tile):
    """tile[m] + vector * a[m]: one factor for all modes."""

    def code(context, builder, sig, args):
        vector = _over_modes(builder, args[0])
        a, tile = (_vectors(builder, arg) for arg in args[1:])
        out = [
            call_intrinsic(builder, "fma", [vector, *terms]) for terms in zip(a, tile, strict=True)
        ]
        return context.make_tuple(builder, sig.return_type, out)

    return tile_type(lane_vector, tile_type, tile_type), code


def _each_mode(instruction):
    """Signature and code of an instruction with two arguments, mode by mode."""

    def code(context, builder, sig, args):
        a, b = (_vectors(builder, arg) for arg in args)
        out = [getattr(builder, instruction)(*terms) for terms in zip(a, b, strict=True)]
        return context.make_tuple(builder, sig.return_type, out)

    return tile_type(tile_type, tile_type), code


@intrinsic
def tile_product(typing_context, a, b):
    """a[m] * b[m]."""
    return _each_mode("fmul")


@intrinsic
def tile_sum(typing_context, a, b):
    """a[m] + b[m]."""
    return _each_mode("fadd")


@intrinsic
def tile_difference(typing_context, a, b):
    """a[m] - b[m]."""
    return _each_mode("fsub")


@intrinsic
def even_and_odd_plus_dot(typing_context, coefficients, j, tile, even, odd):
    """(even, odd): each plus the sum of coefficients[j + m] * tile[m] over its half of the m."""

    def code(context, builder, sig, args):
        factors = _mode_factors(context, builder, sig.args[0], args[0], args[1])
        sums = list(args[3:])
        for m, term in enumerate(_modes(builder, args[2])):
            sums[m % 2] = call_intrinsic(builder, "fma", [factors[m], term, sums[m % 2]])
        return context.make_tuple(builder, sig.return_type, sums)

    two = types.UniTuple(lane_vector, 2)
    return two(coefficients, types.intp, tile_type, lane_vector, lane_vector), code


@intrinsic
def plus_dots(typing_context, coefficients, j, stride, array, i, sums):
    """sums[k] + sum over m < PANEL of coefficients[j + k * stride + m] * array[i + m].

    Even and odd modes in two sums, which halves the latency.
    """

    def code(context, builder, sig, args):
        kinds, (_, j, stride, _, i, _) = sig.args, args
        modes = [
            load_value(context, builder, kinds[3], args[3], _plus(builder, i, m))
            for m in range(PANEL)
        ]
        even, odd = cgutils.unpack_tuple(builder, args[5], sums.count), [None] * sums.count
        starts = [j]
        while len(starts) < sums.count:
            starts.append(builder.add(starts[-1], stride))
        for m, mode in enumerate(modes):
            for k, start in enumerate(starts):
                factor = spread_element(
                    context, builder, kinds[0], args[0], _plus(builder, start, m)
                )
                if m == 1:
                    odd[k] = builder.fmul(factor, mode)
                else:
                    half = odd if m % 2 else even
                    half[k] = call_intrinsic(builder, "fma", [factor, mode, half[k]])
        out = [builder.fadd(*halves) for halves in zip(even, odd, strict=True)]
        return context.make_tuple(builder, sig.return_type, out)

    return sums(coefficients, types.intp, types.intp, array, types.intp, sums), code


rows_type = types.UniTuple(lane_vector, ROWS)


@intrinsic
def load_rows(typing_context, array, r):
    """The ROWS vectors from vector r on."""

    def code(context, builder, sig, args):
        vectors = [
            load_value(context, builder, sig.args[0], args[0], _plus(builder, args[1], k))
            for k in range(ROWS)
        ]
        return context.make_tuple(builder, sig.return_type, vectors)

    return rows_type(array, types.intp), code


@intrinsic
def rows_zero(typing_context):
    """ROWS vectors of zeros."""

    def code(context, builder, sig, args):
        zero = ir.Constant(VECTOR, [0.0] * LANES)
        return context.make_tuple(builder, sig.return_type, [zero] * ROWS)

    return rows_type(), code
