"""Lane vectors: one float64 per lane, in one hardware vector.

A *lane* is one case (load, gap, seed). ``LANES`` cases are integrated side by side, so every state
array ends in an axis of ``LANES``. Lanes never mix: the result of a case does not depend on its
neighbours, bit for bit. The types are plain LLVM vectors: a machine without 512-bit registers runs
the same code on narrower ones.

Arithmetic (+ - * /), unary minus and the comparisons < and > work on lane vectors and on a lane
vector with a float. -a is 0 - a, so that the negative of 0 is 0. A comparison gives a mask, one bit
per lane, for `where`, `any_lane`, `all_lanes`, & and |. No two operations are fused: a fused
multiply-add is written `fma`.
"""

import operator

from llvmlite import ir
from llvmlite.binding import get_host_cpu_features
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

from .compiled import inlined

# integration.entry_points imports this folder again, under names that end in another number.
MOST_LANES = 8
_number = __package__.rpartition("_of_")[2]
LANES = int(_number) if _number.isdigit() else MOST_LANES
REGISTER_LANES = 8 if get_host_cpu_features().get("avx512f") else 4

DOUBLE = ir.DoubleType()
INT32 = ir.IntType(32)
VECTOR = ir.VectorType(DOUBLE, LANES)
MASK = ir.VectorType(ir.IntType(1), LANES)
_SINGLE = ir.VectorType(ir.FloatType(), LANES)
_BITS = ir.IntType(LANES)  # a mask as one number


class LaneVector(types.Type):
    """The numba type of one float64 per lane."""

    def __init__(self) -> None:
        super().__init__(name="LaneVector")


class LaneMask(types.Type):
    """The numba type of one bit per lane."""

    def __init__(self) -> None:
        super().__init__(name="LaneMask")


lane_vector = LaneVector()
lane_mask = LaneMask()


@register_model(LaneVector)
class _LaneVectorModel(models.PrimitiveModel):
    def __init__(self, manager, numba_type):
        super().__init__(manager, numba_type, VECTOR)


@register_model(LaneMask)
class _LaneMaskModel(models.PrimitiveModel):
    def __init__(self, manager, numba_type):
        super().__init__(manager, numba_type, MASK)


# --------------------------------------------------------------------------------------------------
# Operators
# --------------------------------------------------------------------------------------------------
OPERANDS = (  # of an operator with two arguments
    (lane_vector, lane_vector),
    (lane_vector, types.float64),
    (types.float64, lane_vector),
)


@infer_global(operator.add)
@infer_global(operator.sub)
@infer_global(operator.mul)
@infer_global(operator.truediv)
class _Arithmetic(ConcreteTemplate):
    cases = [signature(lane_vector, *operands) for operands in OPERANDS]


@infer_global(operator.lt)
@infer_global(operator.gt)
class _Comparison(ConcreteTemplate):
    cases = [signature(lane_mask, *operands) for operands in OPERANDS]


@infer_global(operator.and_)
@infer_global(operator.or_)
class _MaskLogic(ConcreteTemplate):
    cases = [signature(lane_mask, lane_mask, lane_mask)]


@infer_global(operator.neg)
class _Negation(ConcreteTemplate):
    cases = [signature(lane_vector, lane_vector)]


@lower_builtin(operator.neg, lane_vector)
def _lower_negation(context, builder, sig, args):
    return builder.fsub(ir.Constant(VECTOR, [0.0] * LANES), args[0])


def _lower(python_operator, operands, emit):
    @lower_builtin(python_operator, *operands)
    def _lowered(context, builder, sig, args):
        return emit(builder, *_in_lanes(builder, sig.args, args))


def _in_lanes(builder, kinds, values):
    """The values as vectors, a number spread over the lanes."""
    return [
        value if kind in (lane_vector, lane_mask) else spread_value(builder, value)
        for kind, value in zip(kinds, values, strict=True)
    ]


for _operands in OPERANDS:
    _lower(operator.add, _operands, lambda builder, a, b: builder.fadd(a, b))
    _lower(operator.sub, _operands, lambda builder, a, b: builder.fsub(a, b))
    _lower(operator.mul, _operands, lambda builder, a, b: builder.fmul(a, b))
    _lower(operator.truediv, _operands, lambda builder, a, b: builder.fdiv(a, b))
    _lower(operator.lt, _operands, lambda builder, a, b: builder.fcmp_ordered("<", a, b))
    _lower(operator.gt, _operands, lambda builder, a, b: builder.fcmp_ordered(">", a, b))
_lower(operator.and_, (lane_mask, lane_mask), lambda builder, a, b: builder.and_(a, b))
_lower(operator.or_, (lane_mask, lane_mask), lambda builder, a, b: builder.or_(a, b))


# --------------------------------------------------------------------------------------------------
# Code of single instructions, for the intrinsics here and in panels
# --------------------------------------------------------------------------------------------------
def _address(context, builder, array_type, array, index):
    return builder.gep(context.make_array(array_type)(context, builder, array).data, [index])


def _lane_address(context, builder, array_type, array, vector_index, kind):
    index = builder.mul(vector_index, ir.Constant(vector_index.type, LANES))
    return builder.bitcast(_address(context, builder, array_type, array, index), kind.as_pointer())


def load_value(context, builder, array_type, array, vector_index, kind=VECTOR):
    """Code that loads one vector of an array; of another kind, that and those behind it."""
    at = _lane_address(context, builder, array_type, array, vector_index, kind)
    value = builder.load(at)
    value.align = 8
    return value


def store_value(context, builder, array_type, array, vector_index, value):
    """Code that stores one vector to an array."""
    at = _lane_address(context, builder, array_type, array, vector_index, value.type)
    builder.store(value, at).align = 8


def spread_value(builder, scalar):
    """Code that puts a scalar in every lane."""
    undefined = ir.Constant(VECTOR, ir.Undefined)
    one = builder.insert_element(undefined, scalar, ir.Constant(INT32, 0))
    return builder.shuffle_vector(
        one, undefined, ir.Constant(ir.VectorType(INT32, LANES), [0] * LANES)
    )


def spread_element(context, builder, array_type, array, index):
    """Code for one coefficient as a vector: an element of a flat array in every lane, or, of an
    array (coefficient, lane), its own value in each lane.
    """
    if array_type.ndim == 2:
        return load_value(context, builder, array_type, array, index)
    return spread_value(builder, builder.load(_address(context, builder, array_type, array, index)))


def call_intrinsic(builder, name, args):
    """Code that calls an LLVM intrinsic whose arguments and result are vectors of one kind."""
    vector = args[0].type
    kind = ir.FunctionType(vector, [vector] * len(args))
    return builder.call(
        cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.v{vector.count}f64"),
        args,
    )


# --------------------------------------------------------------------------------------------------
# Functions of lane vectors
# --------------------------------------------------------------------------------------------------
def _operand(kind):
    """The type that an argument has in a signature: a lane vector, or a number."""
    return lane_vector if kind == lane_vector else types.float64


@intrinsic
def spread(typing_context, scalar):
    """The scalar in every lane."""
    return lane_vector(types.float64), lambda context, builder, sig, args: spread_value(
        builder, args[0]
    )


@intrinsic
def spread_from(typing_context, array, i):
    """Coefficient i >= 0 of an array: a flat one in every lane, or (coefficient, lane).

    Faster than spread(array[i]), which tests whether i counts from the end.
    """
    return lane_vector(array, types.intp), lambda context, builder, sig, args: spread_element(
        context, builder, sig.args[0], *args
    )


@intrinsic
def load(typing_context, array, i):
    """Vector i of a contiguous array whose last axis is the lanes."""

    def code(context, builder, sig, args):
        return load_value(context, builder, sig.args[0], args[0], args[1])

    return lane_vector(array, types.intp), code


@intrinsic
def store(typing_context, array, i, value):
    """Write vector i of a contiguous array whose last axis is the lanes."""

    def code(context, builder, sig, args):
        vector = _in_lanes(builder, sig.args[2:], args[2:])[0]
        store_value(context, builder, sig.args[0], args[0], args[1], vector)
        return context.get_dummy_value()

    return types.void(array, types.intp, _operand(value)), code


@intrinsic
def fetch_to_write(typing_context, array, i):
    """Bring vector i of an array to the cache: a store that misses it holds up those behind it."""

    def code(context, builder, sig, args):
        at = _lane_address(context, builder, sig.args[0], *args, ir.IntType(8))
        kind = ir.FunctionType(ir.VoidType(), [at.type] + [INT32] * 3)
        fetch = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")
        flags = [ir.Constant(INT32, flag) for flag in (1, 3, 1)]  # to write, to keep, data
        builder.call(fetch, [at, *flags])
        return context.get_dummy_value()

    return types.void(array, types.intp), code


@intrinsic
def fma(typing_context, a, b, c):
    """a * b + c, rounded once."""

    def code(context, builder, sig, args):
        return call_intrinsic(builder, "fma", _in_lanes(builder, sig.args, args))

    return lane_vector(_operand(a), _operand(b), _operand(c)), code


@intrinsic
def square_root(typing_context, a):
    """Square root of each lane."""
    return lane_vector(lane_vector), lambda context, builder, sig, args: call_intrinsic(
        builder, "sqrt", args
    )


@intrinsic
def magnitude(typing_context, a):
    """Absolute value of each lane."""
    return lane_vector(lane_vector), lambda context, builder, sig, args: call_intrinsic(
        builder, "fabs", args
    )


@intrinsic
def where(typing_context, mask, a, b):
    """Lane by lane: a where the mask is set, else b."""

    def code(context, builder, sig, args):
        return builder.select(args[0], *_in_lanes(builder, sig.args[1:], args[1:]))

    return lane_vector(lane_mask, _operand(a), _operand(b)), code


@intrinsic
def in_every_lane(typing_context, condition):
    """The mask that is set in every lane if the condition holds, else in none."""

    def code(context, builder, sig, args):
        every, none = (ir.Constant(MASK, [bit] * LANES) for bit in (1, 0))
        return builder.select(args[0], every, none)

    return lane_mask(types.boolean), code


@intrinsic
def any_lane(typing_context, mask):
    """True when the mask is set in at least one lane."""

    def code(context, builder, sig, args):
        bits = builder.bitcast(args[0], _BITS)
        return builder.icmp_unsigned("!=", bits, ir.Constant(_BITS, 0))

    return types.boolean(lane_mask), code


@intrinsic
def all_lanes(typing_context, mask):
    """True when the mask is set in every lane."""

    def code(context, builder, sig, args):
        bits = builder.bitcast(args[0], _BITS)
        return builder.icmp_unsigned("==", bits, ir.Constant(_BITS, 2**LANES - 1))

    return types.boolean(lane_mask), code


@intrinsic
def _inverse_root_estimate(typing_context, a):
    """1 / sqrt(a) to single precision, for a >= 1e-37."""

    def code(context, builder, sig, args):
        single = builder.fptrunc(args[0], _SINGLE)
        kind = ir.FunctionType(_SINGLE, [_SINGLE])
        root = cgutils.get_or_insert_function(builder.module, kind, f"llvm.sqrt.v{LANES}f32")
        ones = ir.Constant(_SINGLE, [1.0] * LANES)
        return builder.fpext(builder.fdiv(ones, builder.call(root, [single])), VECTOR)

    return lane_vector(lane_vector), code


@inlined
def inverse_square_root(a):
    """1 / sqrt(a) to double precision; a below 1e-36 counts as 1e-36.

    A single-precision estimate and one iteration of third order: a third of the time of the
    double-precision root and division.
    """
    a = larger(a, spread(1e-36))
    y = _inverse_root_estimate(a)
    e = fma(-1.0 * a * y, y, 1.0)
    return fma(y * e, fma(0.375, e, 0.5), y)


@inlined
def larger(a, b):
    """The larger of two, lane by lane; b if they are equal or one is not a number."""
    return where(a > b, a, b)


@inlined
def smaller(a, b):
    """The smaller of two, lane by lane; a if they are equal or one is not a number."""
    return where(a > b, b, a)


@inlined
def clip(a, limit):
    """The value nearest to a between -limit and limit."""
    return larger(smaller(a, limit), -limit)


@inlined
def add_to(array, i, value):
    """Add a vector to vector i of an array."""
    store(array, i, load(array, i) + value)


@inlined
def raise_to(array, i, value):
    """Replace vector i of an array by value in the lanes in which value is larger."""
    store(array, i, larger(value, load(array, i)))


@inlined
def clear(array):
    """Set every vector of an array to zero."""
    for i in range(array.size // LANES):
        store(array, i, 0.0)
