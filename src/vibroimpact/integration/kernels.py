"""Every compiled function of vibroimpact, and the vector primitives they are written with.

One file on purpose: a cached numba function does not see an edit in a compiled function that it
imports from another file and would silently return the old physics.

Layout. A *lane* is one case (load, gap, seed); ``LANES`` of them are integrated side by side, one
per element of a hardware vector, so every state array ends in an axis of ``LANES`` and lanes never
mix: the result of a case does not depend on its neighbours, bit for bit. A *panel* is ``PANEL``
consecutive modes, each a vector of lanes, held in registers. Modes are padded with zeros to whole
panels. The vector types are plain LLVM vectors: a machine without 512-bit registers runs the same
code on narrower ones.
"""

import operator
import platform
from typing import NamedTuple

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.core import cgutils
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

LANES = 8
PANEL = 8
RATIO = 5  # decimation of the first stage of the output filter
SLOTS = 6  # outputs of the first stage that one input sample contributes to
CHANNEL_BLOCK = 4  # output channels projected at a time
BEHIND = SLOTS // 2 - 1  # ticks between a sample and the output that is finished with it
QUIET = 2  # steps without a force after which all forces kept from the last steps are zero

# Without the run-time's reference counts (_nrt): counting each array of a group at each use costs
# five times the arithmetic. Nothing is allocated in here; work space is handed in.
COMPILED = {"cache": True, "_nrt": False}
INLINE = {"forceinline": True, "_nrt": False}

# --------------------------------------------------------------------------------------------------
# Vector primitives: lane vectors and panels of them
# --------------------------------------------------------------------------------------------------
_DOUBLE = ir.DoubleType()
_INT32 = ir.IntType(32)
_VECTOR = ir.VectorType(_DOUBLE, LANES)


class LaneVector(types.Type):
    """The numba type of one float64 per lane."""

    def __init__(self):
        super().__init__(name="LaneVector")


lane_vector = LaneVector()
panel_type = types.UniTuple(lane_vector, PANEL)


@register_model(LaneVector)
class _LaneVectorModel(models.PrimitiveModel):
    def __init__(self, manager, numba_type):
        super().__init__(manager, numba_type, _VECTOR)


@infer_global(operator.add)
@infer_global(operator.sub)
@infer_global(operator.mul)
@infer_global(operator.truediv)
class _LaneArithmetic(ConcreteTemplate):
    cases = [signature(lane_vector, lane_vector, lane_vector)]


def _lower_arithmetic(python_operator, instruction):
    @lower_builtin(python_operator, lane_vector, lane_vector)
    def _lower(context, builder, sig, args):
        return getattr(builder, instruction)(*args)


for _operator, _instruction in (
    (operator.add, "fadd"),
    (operator.sub, "fsub"),
    (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
):
    _lower_arithmetic(_operator, _instruction)


def _address(context, builder, array_type, array, index):
    return builder.gep(context.make_array(array_type)(context, builder, array).data, [index])


def _offset(builder, index, step):
    return builder.add(index, ir.Constant(index.type, step))


def _lane_address(context, builder, array_type, array, vector_index):
    index = builder.mul(vector_index, ir.Constant(vector_index.type, LANES))
    return builder.bitcast(
        _address(context, builder, array_type, array, index), _VECTOR.as_pointer()
    )


def _load_lanes(context, builder, array_type, array, vector_index):
    value = builder.load(_lane_address(context, builder, array_type, array, vector_index))
    value.align = 8
    return value


def _store_lanes(context, builder, array_type, array, vector_index, value):
    builder.store(value, _lane_address(context, builder, array_type, array, vector_index)).align = 8


def _spread(builder, scalar):
    undefined = ir.Constant(_VECTOR, ir.Undefined)
    one = builder.insert_element(undefined, scalar, ir.Constant(_INT32, 0))
    return builder.shuffle_vector(
        one, undefined, ir.Constant(ir.VectorType(_INT32, LANES), [0] * LANES)
    )


def _spread_from(context, builder, array_type, array, index):
    return _spread(builder, builder.load(_address(context, builder, array_type, array, index)))


def _call(builder, name, args):
    kind = ir.FunctionType(_VECTOR, [_VECTOR] * len(args))
    return builder.call(
        cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.v{LANES}f64"), args
    )


@intrinsic
def spread(typing_context, scalar):
    """The scalar in every lane."""
    return lane_vector(types.float64), lambda context, builder, sig, args: _spread(builder, args[0])


@intrinsic
def spread_from(typing_context, array, i):
    """Element i >= 0 of a flat array of numbers in every lane: without the test for an index from
    the end.
    """
    return lane_vector(array, types.intp), lambda context, builder, sig, args: _spread_from(
        context, builder, sig.args[0], *args
    )


@intrinsic
def load(typing_context, array, i):
    """Vector i of a contiguous array whose last axis is the lanes."""

    def code(context, builder, sig, args):
        return _load_lanes(context, builder, sig.args[0], args[0], args[1])

    return lane_vector(array, types.intp), code


@intrinsic
def store(typing_context, array, i, value):
    """Write vector i of a contiguous array whose last axis is the lanes."""

    def code(context, builder, sig, args):
        _store_lanes(context, builder, sig.args[0], *args)
        return context.get_dummy_value()

    return types.void(array, types.intp, lane_vector), code


@intrinsic
def fma(typing_context, a, b, c):
    """a * b + c, rounded once."""
    sig = lane_vector(lane_vector, lane_vector, lane_vector)
    return sig, lambda context, builder, sig, args: _call(builder, "fma", args)


@intrinsic
def root(typing_context, a):
    """Square root of each lane."""
    return lane_vector(lane_vector), lambda context, builder, sig, args: _call(
        builder, "sqrt", args
    )


_SINGLE = ir.VectorType(ir.FloatType(), LANES)


@intrinsic
def inverse_root_estimate(typing_context, a):
    """1 / sqrt(a) to single precision, for a >= 1e-37."""

    def code(context, builder, sig, args):
        single = builder.fptrunc(args[0], _SINGLE)
        kind = ir.FunctionType(_SINGLE, [_SINGLE])
        square_root = cgutils.get_or_insert_function(builder.module, kind, f"llvm.sqrt.v{LANES}f32")
        ones = ir.Constant(_SINGLE, [1.0] * LANES)
        return builder.fpext(builder.fdiv(ones, builder.call(square_root, [single])), _VECTOR)

    return lane_vector(lane_vector), code


@intrinsic
def magnitude(typing_context, a):
    """Absolute value of each lane."""
    return lane_vector(lane_vector), lambda context, builder, sig, args: _call(
        builder, "fabs", args
    )


@intrinsic
def select_greater(typing_context, a, b, yes, no):
    """Lane by lane: yes where a > b, else no."""

    def code(context, builder, sig, args):
        return builder.select(builder.fcmp_ordered(">", args[0], args[1]), args[2], args[3])

    return lane_vector(*[lane_vector] * 4), code


@intrinsic
def any_greater(typing_context, a, b):
    """True when a > b in at least one lane (False for NaN)."""

    def code(context, builder, sig, args):
        mask = builder.bitcast(builder.fcmp_ordered(">", args[0], args[1]), ir.IntType(LANES))
        return builder.icmp_unsigned("!=", mask, ir.Constant(ir.IntType(LANES), 0))

    return types.boolean(lane_vector, lane_vector), code


_X86 = platform.machine().lower() in ("x86_64", "amd64", "i686")
_FLUSH = 0x8040  # flush-to-zero and denormals-are-zero of the MXCSR register


@intrinsic
def flush_subnormals(typing_context):
    """Let numbers below 1e-308 be zero in this thread; returns the mode before, for `restore_mode`.

    A motion that decays freely passes through them on its way to nothing, and arithmetic on them is
    many times slower: records with rare contacts cost three times as much as those without or with
    many. Machines other than x86 keep them, and their time.
    """

    def code(context, builder, sig, args):
        if not _X86:
            return ir.Constant(_INT32, 0)
        slot = cgutils.alloca_once(builder, _INT32)
        before = _mode(builder, slot, "st")
        builder.store(builder.or_(before, ir.Constant(_INT32, _FLUSH)), slot)
        _mode(builder, slot, "ld")
        return before

    return types.int32(), code


@intrinsic
def restore_mode(typing_context, before):
    """Undo `flush_subnormals`."""

    def code(context, builder, sig, args):
        if _X86:
            slot = cgutils.alloca_once(builder, _INT32)
            builder.store(args[0], slot)
            _mode(builder, slot, "ld")
        return context.get_dummy_value()

    return types.void(types.int32), code


def _mode(builder, slot, direction):
    pointer = ir.IntType(8).as_pointer()
    kind = ir.FunctionType(ir.VoidType(), [pointer])
    builder.call(
        cgutils.get_or_insert_function(builder.module, kind, f"llvm.x86.sse.{direction}mxcsr"),
        [builder.bitcast(slot, pointer)],
    )
    return builder.load(slot)


@intrinsic
def load_panel(typing_context, array, i):
    """The PANEL vectors from vector i on."""

    def code(context, builder, sig, args):
        vectors = [
            _load_lanes(context, builder, sig.args[0], args[0], _offset(builder, args[1], m))
            for m in range(PANEL)
        ]
        return context.make_tuple(builder, sig.return_type, vectors)

    return panel_type(array, types.intp), code


@intrinsic
def store_panel(typing_context, array, i, panel):
    """Write the PANEL vectors from vector i on."""

    def code(context, builder, sig, args):
        for m, vector in enumerate(cgutils.unpack_tuple(builder, args[2], PANEL)):
            _store_lanes(
                context, builder, sig.args[0], args[0], _offset(builder, args[1], m), vector
            )
        return context.get_dummy_value()

    return types.void(array, types.intp, panel_type), code


@intrinsic
def panel_zero(typing_context):
    """A panel of zeros."""

    def code(context, builder, sig, args):
        return context.make_tuple(
            builder, sig.return_type, [ir.Constant(_VECTOR, [0.0] * LANES)] * PANEL
        )

    return panel_type(), code


@intrinsic
def panel_plus_vector(typing_context, coefficients, j, vector, panel):
    """panel[m] + coefficients[j + m] * vector: one force row spread over PANEL modes."""

    def code(context, builder, sig, args):
        out = []
        for m, vector in enumerate(cgutils.unpack_tuple(builder, args[3], PANEL)):
            factor = _spread_from(
                context, builder, sig.args[0], args[0], _offset(builder, args[1], m)
            )
            out.append(_call(builder, "fma", [factor, args[2], vector]))
        return context.make_tuple(builder, sig.return_type, out)

    return panel_type(coefficients, types.intp, lane_vector, panel_type), code


@intrinsic
def panel_plus_scaled(typing_context, coefficients, j, a, panel):
    """panel[m] + coefficients[j + m] * a[m]: one coefficient per mode."""

    def code(context, builder, sig, args):
        out = []
        factors = cgutils.unpack_tuple(builder, args[2], PANEL)
        for m, vector in enumerate(cgutils.unpack_tuple(builder, args[3], PANEL)):
            factor = _spread_from(
                context, builder, sig.args[0], args[0], _offset(builder, args[1], m)
            )
            out.append(_call(builder, "fma", [factor, factors[m], vector]))
        return context.make_tuple(builder, sig.return_type, out)

    return panel_type(coefficients, types.intp, panel_type, panel_type), code


@intrinsic
def panel_product(typing_context, a, b):
    """a[m] * b[m]."""

    def code(context, builder, sig, args):
        a, b = (cgutils.unpack_tuple(builder, arg, PANEL) for arg in args)
        return context.make_tuple(
            builder, sig.return_type, [builder.fmul(a[m], b[m]) for m in range(PANEL)]
        )

    return panel_type(panel_type, panel_type), code


@intrinsic
def panel_plus_common(typing_context, vector, a, panel):
    """panel[m] + vector * a[m]: one factor for all modes."""

    def code(context, builder, sig, args):
        a, c = (cgutils.unpack_tuple(builder, arg, PANEL) for arg in args[1:])
        out = [_call(builder, "fma", [args[0], a[m], c[m]]) for m in range(PANEL)]
        return context.make_tuple(builder, sig.return_type, out)

    return panel_type(lane_vector, panel_type, panel_type), code


@intrinsic
def panel_sum(typing_context, a, b):
    """a[m] + b[m]."""

    def code(context, builder, sig, args):
        a, b = (cgutils.unpack_tuple(builder, arg, PANEL) for arg in args)
        return context.make_tuple(
            builder, sig.return_type, [builder.fadd(a[m], b[m]) for m in range(PANEL)]
        )

    return panel_type(panel_type, panel_type), code


@intrinsic
def panel_difference(typing_context, a, b):
    """a[m] - b[m]."""

    def code(context, builder, sig, args):
        a, b = (cgutils.unpack_tuple(builder, arg, PANEL) for arg in args)
        return context.make_tuple(
            builder, sig.return_type, [builder.fsub(a[m], b[m]) for m in range(PANEL)]
        )

    return panel_type(panel_type, panel_type), code


@intrinsic
def vector_plus_dot(typing_context, coefficients, j, panel, vector):
    """vector + sum over m of coefficients[j + m] * panel[m]: PANEL modes projected on one row."""

    def code(context, builder, sig, args):
        terms = cgutils.unpack_tuple(builder, args[2], PANEL)
        factors = [
            _spread_from(context, builder, sig.args[0], args[0], _offset(builder, args[1], m))
            for m in range(PANEL)
        ]
        total, other = args[3], builder.fmul(factors[1], terms[1])  # two chains: half the latency
        for m in range(0, PANEL, 2):
            total = _call(builder, "fma", [factors[m], terms[m], total])
            if m > 0:
                other = _call(builder, "fma", [factors[m + 1], terms[m + 1], other])
        return builder.fadd(total, other)

    return lane_vector(coefficients, types.intp, panel_type, lane_vector), code


# --------------------------------------------------------------------------------------------------
# What the kernel works on. Shapes in axis names; every (.., lane) array is contiguous.
# --------------------------------------------------------------------------------------------------
class Modal(NamedTuple):
    """The modes, in uncoupled groups (in plane, out of plane), each padded to whole panels.

    A *row* is one scalar generalised displacement of a group: its contact directions first, then
    its local elements, then its force channels. ``shapes`` holds for each group a (row, mode of the
    group) matrix, flat, from ``shape_start``.
    """

    dt: float
    mode_start: np.ndarray  # (group + 1,) first mode of each group, multiples of PANEL
    row_start: np.ndarray  # (group + 1,) first row of each group
    force_row_start: np.ndarray  # (group,) first row of each group that is a force channel
    row_force_channel: (
        np.ndarray
    )  # (row,) force channel of the row, -1 for a contact or element row
    shapes: np.ndarray  # flat [kg^-1/2]
    shape_start: np.ndarray  # (group,)
    push: np.ndarray  # (mode,) the step of a mode, see schemes.StepCoefficients
    shift: np.ndarray  # (mode,)
    decay: np.ndarray  # (mode,)
    restore: np.ndarray  # (mode,)
    kick: np.ndarray  # (mode,)
    loss: np.ndarray  # (mode,) damping / dt: energy lost in a step per displacement²
    speed: np.ndarray  # (4,) velocity of a row at the end of a step, see row_speed
    compliance: (
        np.ndarray
    )  # flat (row, row) of each group [m/N]: displacement at the end of a step per force there
    compliance_start: np.ndarray  # (group,)


class Contact(NamedTuple):
    """Local force laws at the contact points, one column per parameter, each (point, lane)."""

    row_1: np.ndarray  # (point,) row of the first transverse direction
    row_2: np.ndarray  # (point,) row of the second
    support: np.ndarray  # (point,) support the point belongs to
    stiffness: np.ndarray  # (point, lane) N/m
    gap: np.ndarray  # (point, lane) m
    offset_1: np.ndarray  # (point, lane) m
    offset_2: np.ndarray  # (point, lane) m
    plain: np.ndarray  # (point,) 1: nothing but the elastic circle; 0: see Laws
    tolerance: float  # relative change of the contact forces at which the fixed point stops
    passes: int  # at most
    limit: float  # m, a displacement beyond it means that the run has diverged


class Laws(NamedTuple):
    """What goes beyond the elastic circle: contact laws, one per special point or flat land, then
    local elements.

    A special point has gap inf and stiffness anything in Contact, so that the plain loop never sees
    it touch.
    """

    point: np.ndarray  # (law,) contact point
    flat: np.ndarray  # (law,) 1: a land with the normal below; 0: round the centre
    normal_1: np.ndarray  # (law,)
    normal_2: np.ndarray  # (law,)
    lobes: np.ndarray  # (law,) 0: a circle
    lobe_depth: np.ndarray  # (law, lane) m
    lobe_cosine: np.ndarray  # (law, lane) of the lobes' angle
    lobe_sine: np.ndarray  # (law, lane)
    gap: np.ndarray  # (law, lane) m
    stiffness: np.ndarray  # (law, lane) N/m, 0 where the law is Hertz's
    hertz: np.ndarray  # (law, lane) N/m^1.5
    hunt_crossley: np.ndarray  # (law, lane) s/m
    damping: np.ndarray  # (law, lane) N s/m
    friction: np.ndarray  # (law, lane)
    stick_stiffness: np.ndarray  # (law, lane) N/m
    stick_flexibility: np.ndarray  # (law, lane) m/N, its inverse, 0 without friction
    row: np.ndarray  # (element,)
    element_stiffness: np.ndarray  # (element, lane) N/m
    quadratic: np.ndarray  # (element, lane) N/m²
    cubic: np.ndarray  # (element, lane) N/m³
    element_damping: np.ndarray  # (element, lane) N s/m
    drag: np.ndarray  # (element, lane) N s²/m²
    partner_row: (
        np.ndarray
    )  # (element,) row of the motion across that counts in the speed of the drag, -1 for none
    element_stick: np.ndarray  # (element, lane) N/m
    element_flexibility: np.ndarray  # (element, lane) m/N, its inverse, 0 without a slider
    slip_limit: np.ndarray  # (element, lane) N
    saturation_stiffness: np.ndarray  # (element, lane) N/m
    saturation_limit: np.ndarray  # (element, lane) N


class Trace(NamedTuple):
    """Every step of the contact and element rows, (row, step, lane); no steps: not kept."""

    displacement: np.ndarray  # m
    force: np.ndarray  # N, on the structure
    steps: int


class State(NamedTuple):
    """What one step hands to the next."""

    displacement: (
        np.ndarray
    )  # (RATIO, mode, lane) m kg^1/2, the last RATIO steps, the present one last between ticks
    ahead: (
        np.ndarray
    )  # (mode, lane) displacement at the end of the next step if no force acted there
    change: np.ndarray  # (mode, lane) what of it is the step's own
    awake: np.ndarray  # (group,) int64: 0 while nothing has moved the group's modes
    row_displacement: np.ndarray  # (row, lane) m
    row_velocity: np.ndarray  # (row, lane) m/s, kept where there are Laws; see row_speed
    row_force: np.ndarray  # (row, lane) N, force on the structure at the end of the last step
    row_force_before: np.ndarray  # (row, lane) N, one step earlier (starts the fixed point)
    row_pull: np.ndarray  # (row, lane) m, compliance times row_force
    row_pull_before: np.ndarray  # (row, lane) m
    stick: np.ndarray  # (law, lane) N, friction force along the law's tangent
    slider: np.ndarray  # (element, lane) N, force of the slider
    touching: np.ndarray  # (support, lane) 1.0 while in contact
    average: np.ndarray  # (slot, mode + extra channel, lane) first stage of the output filter
    flag: (
        np.ndarray
    )  # (2,) int64: steps since contacts or elements last bore a force, 0 to 2; steps done


class Tally(NamedTuple):
    """Sums over the steps since they were last cleared, each (.., lane)."""

    input_work: np.ndarray  # (lane,) J
    contact_work: np.ndarray  # (lane,) J, trapezoidal sum of f du over contacts and elements
    dissipated: np.ndarray  # (lane,) J, by the modal damping
    contact_steps: np.ndarray  # (support, lane)
    impacts: np.ndarray  # (support, lane)
    peak_force: np.ndarray  # (support, lane) N
    square_force: np.ndarray  # (support, lane) N² sum
    force_sum: np.ndarray  # (support, lane) N sum
    impact_velocity_square: np.ndarray  # (support, lane) (m/s)² sum over impacts
    impact_velocity_peak: np.ndarray  # (support, lane) m/s
    sliding_work: np.ndarray  # (support, lane) J: normal force times sliding distance
    force_displacement: np.ndarray  # (row, lane) N m sum of force times displacement
    square_displacement: np.ndarray  # (row, lane) m² sum, every RATIO-th step
    element_work: np.ndarray  # (element, lane) J, trapezoidal sum of f du
    slip_work: np.ndarray  # (element, lane) J, slider force times slip
    residual: np.ndarray  # (lane,) largest relative change in the last pass of the fixed point
    square_stress: np.ndarray  # (section, lane) Pa² sum
    peak_square_stress: np.ndarray  # (section, lane) Pa²


class Work(NamedTuple):
    """Scratch space of a step."""

    free: np.ndarray  # (row, lane) m
    displacement: np.ndarray  # (row, lane) m
    force: np.ndarray  # (row, lane) N
    pull: np.ndarray  # (row, lane) m
    resultant: np.ndarray  # (support, 2, lane) N
    fresh: np.ndarray  # (row, lane) N, forces of one pass
    stick: np.ndarray  # (law, lane) N
    slider: np.ndarray  # (element, lane) N
    held_stick: np.ndarray  # (law, lane) N
    held_slider: np.ndarray  # (element, lane) N
    channels: np.ndarray  # (displacement channel + 2 stress channels per section + 1, lane)


class Output(NamedTuple):
    """What is kept at the first decimated rate."""

    weights: np.ndarray  # (RATIO, SLOTS) first-stage filter, by phase and slot
    channel_start: np.ndarray  # (group + 1,) first entry of each group in channel
    # (group,) first entry of each group that is a stress, a whole number of blocks from
    # channel_start
    stress_entry: np.ndarray
    # (entry,) output channel that the entry adds to; displacements first, then stresses; the last
    channel: np.ndarray
    # channel takes the entries that fill a group's last block of CHANNEL_BLOCK
    shapes: np.ndarray  # flat, for each entry the shape over the modes of its group
    shape_start: np.ndarray  # (entry,)
    stress_start: int  # first stress channel: two per section
    stress_weight: (
        np.ndarray
    )  # (RATIO,) steps that a stress taken at a phase stands for, 0 where none is taken
    # number of supports: their force resultants follow, two per support, then the force channels
    extra_support: int
    values: (
        np.ndarray
    )  # (displacement channel + extra channel, column, lane): displacement [m], forces [N]
    columns: int  # columns of values
    column: int  # the one that the first tick of this call is written to


# --------------------------------------------------------------------------------------------------
# The step
# --------------------------------------------------------------------------------------------------
@njit(**INLINE)
def clear(array):
    """Every vector of an array to zero."""
    for i in range(array.size // LANES):
        store(array, i, spread(0.0))


@njit(**INLINE)
def project(modal, g, i, panel, rows):
    """Add what one panel of group g displaces its rows by to ``rows``."""
    width = modal.mode_start[g + 1] - modal.mode_start[g]
    at = modal.shape_start[g] + i - modal.mode_start[g]
    for r in range(modal.row_start[g], modal.row_start[g + 1]):
        store(rows, r, vector_plus_dot(modal.shapes, at, panel, load(rows, r)))
        at += width


@njit(**INLINE)
def project_ahead(modal, state, free):
    """Row displacements at the end of the first step of a call if no force acted there: ``free``
    (row, lane).
    """
    clear(free)
    for g in range(modal.mode_start.size - 1):
        for i in range(modal.mode_start[g], modal.mode_start[g + 1], PANEL):
            project(modal, g, i, load_panel(state.ahead, i), free)


@njit(**INLINE)
def apply_drive(modal, drive, n, forces, force, free):
    """Put the drive forces at the end of step n on their rows of ``force``, and what they move
    there on top of ``free``.
    """
    for g in range(modal.row_start.size - 1):
        row0, row1 = modal.row_start[g], modal.row_start[g + 1]
        for f in range(modal.force_row_start[g], row1):
            value = load(drive, n * forces + modal.row_force_channel[f])
            store(force, f, value)
            at = modal.compliance_start[g] + f - row0
            for r in range(row0, row1):
                store(free, r, fma(spread_from(modal.compliance, at), value, load(free, r)))
                at += row1 - row0


@njit(**INLINE)
def tally_drive(modal, state, tally, free, force, active):
    """Displacement of the force rows at the end of the step, which ``free`` becomes there, and the
    work of the drive.
    """
    half = spread(0.5)
    work = load(tally.input_work, 0)
    for g in range(modal.row_start.size - 1):
        row0, row_f, row1 = modal.row_start[g], modal.force_row_start[g], modal.row_start[g + 1]
        for f in range(row_f, row1):
            u = load(free, f)
            if active:
                at = modal.compliance_start[g] + (f - row0) * (row1 - row0)
                for r in range(row0, row_f):
                    u = fma(spread_from(modal.compliance, at + r - row0), load(force, r), u)
            moved = u - load(state.row_displacement, f)
            work = fma(half * (load(force, f) + load(state.row_force, f)), moved, work)
            store(state.row_displacement, f, u)
            store(state.row_force, f, load(force, f))
    store(tally.input_work, 0, work)


@njit(**INLINE)
def yield_to(modal, force, pull):
    """pull = compliance @ force on the contact and element rows of every group, each (row, lane);
    five rows at a time.
    """
    for g in range(modal.row_start.size - 1):
        row0, row_f = modal.row_start[g], modal.force_row_start[g]
        stride = modal.row_start[g + 1] - row0
        at = modal.compliance_start[g]
        r = row0
        while r + 5 <= row_f:
            a, b, c, d, e = spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0)
            for s in range(row_f - row0):
                f = load(force, row0 + s)
                a = fma(spread_from(modal.compliance, at + s), f, a)
                b = fma(spread_from(modal.compliance, at + stride + s), f, b)
                c = fma(spread_from(modal.compliance, at + 2 * stride + s), f, c)
                d = fma(spread_from(modal.compliance, at + 3 * stride + s), f, d)
                e = fma(spread_from(modal.compliance, at + 4 * stride + s), f, e)
            store(pull, r, a)
            store(pull, r + 1, b)
            store(pull, r + 2, c)
            store(pull, r + 3, d)
            store(pull, r + 4, e)
            r += 5
            at += 5 * stride
        while r < row_f:
            a = spread(0.0)
            for s in range(row_f - row0):
                a = fma(spread_from(modal.compliance, at + s), load(force, row0 + s), a)
            store(pull, r, a)
            r += 1
            at += stride


@njit(**INLINE)
def inverse_root(a):
    """1 / sqrt(a) to double precision; a below 1e-36 counts as 1e-36.

    A single-precision estimate and one step of third order cost a third of the double-precision
    root and division.
    """
    least = spread(1e-36)
    a = select_greater(a, least, a, least)
    y = inverse_root_estimate(a)
    e = fma(spread(-1.0) * a * y, y, spread(1.0))
    return fma(y * e, fma(spread(0.375), e, spread(0.5)), y)


@njit(**INLINE)
def reach(contact, p, u1, u2):
    """Distance from the obstacle's centre less the gap is the penetration: (d1, d2, d², gap)."""
    d1 = u1 - load(contact.offset_1, p)
    d2 = u2 - load(contact.offset_2, p)
    return d1, d2, fma(d1, d1, d2 * d2), load(contact.gap, p)


@njit(**INLINE)
def contact_forces(contact, p, u1, u2):
    """Force on the structure at point p along its two directions: radial, unilateral, circular
    obstacle.
    """
    d1, d2, square, gap = reach(contact, p, u1, u2)
    # -k (r - gap) d / r = k (gap / r - 1) d, kept only where r > gap; no branch: with lanes of
    # their own it would be guessed wrong too often
    per_metre = load(contact.stiffness, p) * fma(gap, inverse_root(square), spread(-1.0))
    per_metre = select_greater(square, gap * gap, per_metre, spread(0.0))
    return per_metre * d1, per_metre * d2


@njit(**INLINE)
def larger(a, b):
    """The larger of two, lane by lane."""
    return select_greater(a, b, a, b)


@njit(**INLINE)
def clip(a, limit):
    """a held between -limit and limit."""
    zero = spread(0.0)
    a = select_greater(a, limit, limit, a)
    return larger(a, zero - limit)


@njit(**INLINE)
def penetration(contact, laws, k, u1, u2):
    """Gradient of the penetration of law k, its length, and the penetration: (n1, n2, length, p), p
    < 0 when apart.

    Round: phi = r - R(theta) with R = gap + depth (1 - cos(lobes (theta - angle))) / 2; the force
    -k phi grad(phi) has the potential k phi²/2 and acts along the normal of the profile. cos and
    sin of the multiple angle by complex powers.
    """
    zero, one = spread(0.0), spread(1.0)
    at = laws.point[k]
    d1, d2 = u1 - load(contact.offset_1, at), u2 - load(contact.offset_2, at)
    gap = load(laws.gap, k)
    if laws.flat[k] != 0:
        n1, n2 = spread(laws.normal_1[k]), spread(laws.normal_2[k])
        return n1, n2, one, fma(n1, d1, n2 * d2) - gap
    square = fma(d1, d1, d2 * d2)
    inverse = inverse_root(square)
    n1, n2 = d1 * inverse, d2 * inverse
    distance = square * inverse
    if laws.lobes[k] == 0:
        return n1, n2, one, distance - gap
    c0, s0 = load(laws.lobe_cosine, k), load(laws.lobe_sine, k)
    c1, s1 = fma(n1, c0, n2 * s0), fma(n2, c0, zero - n1 * s0)
    c, s = c1, s1
    for _ in range(laws.lobes[k] - 1):
        c, s = fma(c, c1, zero - s * s1), fma(s, c1, c * s1)
    half_depth = spread(0.5) * load(laws.lobe_depth, k)
    slope = half_depth * spread(1.0 * laws.lobes[k]) * s * inverse
    return (
        fma(slope, n2, n1),
        fma(zero - slope, n1, n2),
        root(fma(slope, slope, one)),
        distance - fma(half_depth, one - c, gap),
    )


@njit(**INLINE)
def normal_force(laws, k, p, speed, dt):
    """Force of law k per unit gradient, never negative: p penetration, speed its rate.

    Kelvin-Voigt counts from the part of the step spent in contact, min(c speed, c p / dt) while
    closing: it begins at 0 and the implicit equation has a solution at every first touch.
    """
    zero, one = spread(0.0), spread(1.0)
    p = larger(p, zero)
    force = p * fma(load(laws.hertz, k), root(p), load(laws.stiffness, k))
    force = force * larger(fma(load(laws.hunt_crossley, k), speed, one), zero)
    c = load(laws.damping, k)
    closing, ramp = c * speed, c * p * spread(1.0 / dt)
    return larger(force + select_greater(closing, ramp, ramp, closing), zero)


@njit(**INLINE)
def friction_force(laws, state, k, slip, normal):
    """Force along the tangent (-n2, n1) of law k: elastic stick spring from the state, Coulomb slip
    at friction times normal.
    """
    trial = fma(spread(-1.0) * load(laws.stick_stiffness, k), slip, load(state.stick, k))
    return clip(trial, load(laws.friction, k) * normal)


@njit(**INLINE)
def element_force(laws, state, e, u, v, speed, moved):
    """Force of local element e on the structure and that of its slider: (force, slider); v its
    rate, speed the size of the motion that drags.
    """
    slider = fma(spread(-1.0) * load(laws.element_stick, e), moved, load(state.slider, e))
    slider = clip(slider, load(laws.slip_limit, e))
    stiffness = fma(
        u, fma(u, load(laws.cubic, e), load(laws.quadratic, e)), load(laws.element_stiffness, e)
    )
    force = fma(stiffness, u, fma(load(laws.drag, e), speed, load(laws.element_damping, e)) * v)
    return (
        slider
        - force
        - clip(load(laws.saturation_stiffness, e) * u, load(laws.saturation_limit, e)),
        slider,
    )


@njit(**INLINE)
def row_speed(modal, state, u, r):
    """End-of-step velocity of row r from its displacement and what the last step left in
    row_velocity.

    Newmark: 2 du/dt less the last velocity, exact for the scheme. Exact modal step: second-order
    backward difference 1.5 du/dt - 0.5 (du/dt of the last step).
    """
    moved = u - load(state.row_displacement, r)
    return fma(spread(modal.speed[0]), moved, spread(modal.speed[1]) * load(state.row_velocity, r))


@njit(**INLINE)
def all_forces(modal, contact, laws, state, work, u):
    """Forces of every contact and element at displacements u: work.fresh; friction and sliders to
    work.stick and work.slider.
    """
    zero = spread(0.0)
    for p in range(contact.row_1.size):
        r1, r2 = contact.row_1[p], contact.row_2[p]
        f1, f2 = contact_forces(contact, p, load(u, r1), load(u, r2))
        store(work.fresh, r1, f1)
        store(work.fresh, r2, f2)
    for k in range(laws.point.size):
        r1, r2 = contact.row_1[laws.point[k]], contact.row_2[laws.point[k]]
        u1, u2 = load(u, r1), load(u, r2)
        n1, n2, length, p = penetration(contact, laws, k, u1, u2)
        if not any_greater(p, zero):
            store(work.stick, k, zero)
            continue
        speed = fma(n1, row_speed(modal, state, u1, r1), n2 * row_speed(modal, state, u2, r2))
        f = normal_force(laws, k, p, speed, modal.dt)
        slip = (
            fma(
                n1,
                u2 - load(state.row_displacement, r2),
                zero - n2 * (u1 - load(state.row_displacement, r1)),
            )
            / length
        )
        stick = friction_force(laws, state, k, slip, f * length)
        store(work.stick, k, stick)
        stick = stick / length
        store(work.fresh, r1, load(work.fresh, r1) - fma(f, n1, stick * n2))
        store(work.fresh, r2, load(work.fresh, r2) - fma(f, n2, zero - stick * n1))
    for e in range(laws.row.size):
        r = laws.row[e]
        ur = load(u, r)
        v = row_speed(modal, state, ur, r)
        speed, across = magnitude(v), laws.partner_row[e]
        if across >= 0:
            w = row_speed(modal, state, load(u, across), across)
            speed = root(fma(v, v, w * w))
        f, slider = element_force(
            laws, state, e, ur, v, speed, ur - load(state.row_displacement, r)
        )
        store(work.fresh, r, f)
        store(work.slider, e, slider)


@njit(**INLINE)
def solve_laws(contact, laws, modal, state, tally, work):
    """solve_contact where there are Laws: the same fixed point over contact and element rows. True
    if any lane may bear a force.
    """
    free, u, force, pull = work.free, work.displacement, work.force, work.pull
    zero, one, half = spread(0.0), spread(1.0), spread(0.5)
    opened = one if laws.row.size > 0 else zero
    for p in range(contact.row_1.size):
        _, _, square, gap = reach(
            contact, p, load(free, contact.row_1[p]), load(free, contact.row_2[p])
        )
        opened = select_greater(square, gap * gap, one, opened)
    for k in range(laws.point.size):
        at = laws.point[k]
        _, _, _, p = penetration(
            contact, laws, k, load(free, contact.row_1[at]), load(free, contact.row_2[at])
        )
        opened = select_greater(p, zero, one, opened)
        store(work.stick, k, zero)
    near = any_greater(opened, half)
    for g in range(modal.row_start.size - 1):
        for r in range(modal.row_start[g], modal.force_row_start[g]):
            f, move = load(state.row_force, r), load(state.row_pull, r)
            f = select_greater(opened, half, f + f - load(state.row_force_before, r), zero)
            move = select_greater(opened, half, move + move - load(state.row_pull_before, r), zero)
            store(force, r, f)
            store(pull, r, move)
            store(u, r, load(free, r) + move)
    if not near:
        return False
    change, size = zero, zero
    tolerance = spread(contact.tolerance)
    held_stick, held_slider = work.held_stick, work.held_slider
    for k in range(laws.point.size):
        store(held_stick, k, zero)
    for _ in range(contact.passes):
        moved, size = zero, zero
        all_forces(modal, contact, laws, state, work, u)
        for k in range(laws.point.size):
            store(
                held_stick,
                k,
                select_greater(opened, half, load(work.stick, k), load(held_stick, k)),
            )
        for e in range(laws.row.size):
            store(
                held_slider,
                e,
                select_greater(opened, half, load(work.slider, e), load(held_slider, e)),
            )
        for g in range(modal.row_start.size - 1):
            for r in range(modal.row_start[g], modal.force_row_start[g]):
                old = load(force, r)
                f = select_greater(opened, half, load(work.fresh, r), old)
                moved = moved + magnitude(f - old)
                size = size + magnitude(f)
                store(force, r, f)
        change = select_greater(opened, half, moved, change)
        yield_to(modal, force, pull)
        for g in range(modal.row_start.size - 1):
            for r in range(modal.row_start[g], modal.force_row_start[g]):
                store(u, r, load(free, r) + load(pull, r))
        opened = select_greater(moved, tolerance * size, opened, zero)
        if not any_greater(opened, half):
            break
    for k in range(laws.point.size):
        store(work.stick, k, load(held_stick, k))
    for e in range(laws.row.size):
        store(work.slider, e, load(held_slider, e))
    worst = load(tally.residual, 0)
    relative = select_greater(size, zero, change / size, zero)
    store(tally.residual, 0, larger(relative, worst))
    return True


@njit(**INLINE)
def tally_laws(modal, contact, laws, state, tally, work):
    """Work of the elements, slip of sliders and wear of special contacts in one step; state still
    holds its start.
    """
    zero, half = spread(0.0), spread(0.5)
    u, force = work.displacement, work.force
    total = load(tally.contact_work, 0)
    for e in range(laws.row.size):
        r = laws.row[e]
        moved = load(u, r) - load(state.row_displacement, r)
        done = half * (load(force, r) + load(state.row_force, r)) * moved
        total = total + done
        store(tally.element_work, e, load(tally.element_work, e) + done)
        slip = fma(
            load(work.slider, e) - load(state.slider, e), load(laws.element_flexibility, e), moved
        )
        store(
            tally.slip_work,
            e,
            fma(magnitude(load(work.slider, e)), magnitude(slip), load(tally.slip_work, e)),
        )
        store(
            tally.force_displacement,
            r,
            fma(load(force, r), load(u, r), load(tally.force_displacement, r)),
        )
        store(state.slider, e, load(work.slider, e))
    store(tally.contact_work, 0, total)
    for k in range(laws.point.size):
        at = laws.point[k]
        r1, r2 = contact.row_1[at], contact.row_2[at]
        u1, u2, stick = load(u, r1), load(u, r2), load(work.stick, k)
        n1, n2, length, p = penetration(contact, laws, k, u1, u2)
        if any_greater(p, zero):
            speed = fma(n1, row_speed(modal, state, u1, r1), n2 * row_speed(modal, state, u2, r2))
            normal = normal_force(laws, k, p, speed, modal.dt) * length
            slip = (
                fma(
                    n1,
                    u2 - load(state.row_displacement, r2),
                    zero - n2 * (u1 - load(state.row_displacement, r1)),
                )
                / length
            )
            slip = fma(stick - load(state.stick, k), load(laws.stick_flexibility, k), slip)
            s = contact.support[at]
            store(tally.sliding_work, s, fma(normal, magnitude(slip), load(tally.sliding_work, s)))
        store(state.stick, k, stick)


@njit(**COMPILED)
def begin(modal, contact, laws, state, work):
    """Forces of contacts and elements, and their pull, at the initial state.row_displacement and
    row_velocity: fills state.row_*.
    """
    rows = state.row_velocity.size // LANES
    clear(work.fresh)
    for r in range(rows):
        store(work.displacement, r, load(state.row_displacement, r))
        # so that row_speed at rest in this step gives the velocity itself
        store(state.row_velocity, r, load(state.row_velocity, r) / spread(modal.speed[1]))
    all_forces(modal, contact, laws, state, work, work.displacement)
    for r in range(rows):
        store(state.row_velocity, r, load(state.row_velocity, r) * spread(modal.speed[1]))
        store(state.row_force, r, load(work.fresh, r))
        store(state.row_force_before, r, load(work.fresh, r))
    yield_to(modal, state.row_force, state.row_pull)
    yield_to(modal, state.row_force_before, state.row_pull_before)
    state.flag[0] = 0


@njit(**INLINE)
def solve_contact(contact, modal, state, tally, free, u, force, pull):
    """End-of-step contact forces and contact-row displacements, implicit; True if any lane may be
    in contact.

    Solves u = free + G f(u), G the compliance of a step, by fixed point, lane by lane: a lane whose
    forces have settled is frozen, so it does not see how many passes its neighbours need. The
    contraction factor is checked before the run (contraction.contact_contraction). Products with G
    are kept from step to step (``pull``). Where nothing is near and has not been for two steps,
    nothing is written: u is free, and all forces are zero as they were.
    """
    zero, one, half = spread(0.0), spread(1.0), spread(0.5)
    opened = zero
    for p in range(contact.row_1.size):
        _, _, square, gap = reach(
            contact, p, load(free, contact.row_1[p]), load(free, contact.row_2[p])
        )
        opened = select_greater(square, gap * gap, one, opened)
    near = any_greater(opened, half)
    if not near and state.flag[0] >= QUIET:
        return False
    for p in range(contact.row_1.size):
        for r in (contact.row_1[p], contact.row_2[p]):
            # start from the forces of the last two steps, extrapolated
            f, move = load(state.row_force, r), load(state.row_pull, r)
            f = select_greater(opened, half, f + f - load(state.row_force_before, r), zero)
            move = select_greater(opened, half, move + move - load(state.row_pull_before, r), zero)
            store(force, r, f)
            store(pull, r, move)
            store(u, r, load(free, r) + move)
    if not near:
        return False
    change, size = zero, zero
    tolerance = spread(contact.tolerance)
    for _ in range(contact.passes):
        moved, size = zero, zero
        for p in range(contact.row_1.size):
            r1, r2 = contact.row_1[p], contact.row_2[p]
            f1, f2 = contact_forces(contact, p, load(u, r1), load(u, r2))
            old1, old2 = load(force, r1), load(force, r2)
            f1 = select_greater(opened, half, f1, old1)
            f2 = select_greater(opened, half, f2, old2)
            moved = moved + magnitude(f1 - old1) + magnitude(f2 - old2)
            size = size + magnitude(f1) + magnitude(f2)
            store(force, r1, f1)
            store(force, r2, f2)
        change = select_greater(opened, half, moved, change)
        yield_to(modal, force, pull)
        for p in range(contact.row_1.size):
            for r in (contact.row_1[p], contact.row_2[p]):
                store(u, r, load(free, r) + load(pull, r))
        opened = select_greater(moved, tolerance * size, opened, zero)
        if not any_greater(opened, half):
            break
    worst = load(tally.residual, 0)
    relative = select_greater(size, zero, change / size, zero)
    store(tally.residual, 0, larger(relative, worst))
    return True


@njit(**INLINE)
def impact_speed(modal, contact, state, u, force, first, s):
    """Largest outward speed over a step among the points of support s (from point ``first`` on)
    that bear a force.
    """
    speed, zero = spread(0.0), spread(0.0)
    p = first
    while p < contact.row_1.size and contact.support[p] == s:
        r1, r2 = contact.row_1[p], contact.row_2[p]
        f1, f2 = load(force, r1), load(force, r2)
        square = fma(f1, f1, f2 * f2)
        du1 = load(u, r1) - load(state.row_displacement, r1)
        du2 = load(u, r2) - load(state.row_displacement, r2)
        # the force points inwards along the radius
        outward = select_greater(square, zero, (zero - fma(f1, du1, f2 * du2)) / root(square), zero)
        speed = select_greater(outward, speed, outward, speed)
        p += 1
    return speed * spread(1.0 / modal.dt)


@njit(**INLINE)
def tally_contact(modal, contact, state, tally, u, force, resultants):
    """Contact work and statistics of one step, forces of the supports; state.row_* still hold its
    start. 1 if any lane touches.
    """
    zero, one, half = spread(0.0), spread(1.0), spread(0.5)
    work = load(tally.contact_work, 0)
    touched = 0
    p = 0
    for s in range(tally.impacts.size // LANES):
        first = p
        sum1, sum2, borne = zero, zero, zero
        sliding = load(tally.sliding_work, s)
        while p < contact.row_1.size and contact.support[p] == s:
            r1, r2 = contact.row_1[p], contact.row_2[p]
            u1, u2, f1, f2 = load(u, r1), load(u, r2), load(force, r1), load(force, r2)
            du1, du2 = u1 - load(state.row_displacement, r1), u2 - load(state.row_displacement, r2)
            work = fma(half * (f1 + load(state.row_force, r1)), du1, work)
            work = fma(half * (f2 + load(state.row_force, r2)), du2, work)
            store(tally.force_displacement, r1, fma(f1, u1, load(tally.force_displacement, r1)))
            store(tally.force_displacement, r2, fma(f2, u2, load(tally.force_displacement, r2)))
            if contact.plain[p] != 0:
                sliding = sliding + magnitude(
                    fma(f1, du2, zero - f2 * du1)
                )  # |f| times the slip across it
            borne = borne + magnitude(f1) + magnitude(f2)
            sum1, sum2 = sum1 + f1, sum2 + f2
            p += 1
        store(resultants, 2 * s, sum1)
        store(resultants, 2 * s + 1, sum2)
        contact_now = select_greater(borne, zero, one, zero)
        if any_greater(contact_now, half):
            touched = 1
            square = fma(sum1, sum1, sum2 * sum2)
            resultant = root(square)
            peak = load(tally.peak_force, s)
            store(tally.peak_force, s, select_greater(resultant, peak, resultant, peak))
            store(tally.square_force, s, load(tally.square_force, s) + square)
            store(tally.force_sum, s, load(tally.force_sum, s) + resultant)
            store(tally.contact_steps, s, load(tally.contact_steps, s) + contact_now)
            store(tally.sliding_work, s, sliding)
            onset = select_greater(contact_now, load(state.touching, s), one, zero)
            if any_greater(onset, half):
                speed = onset * impact_speed(modal, contact, state, u, force, first, s)
                store(tally.impacts, s, load(tally.impacts, s) + onset)
                store(
                    tally.impact_velocity_square,
                    s,
                    fma(speed, speed, load(tally.impact_velocity_square, s)),
                )
                peak = load(tally.impact_velocity_peak, s)
                store(tally.impact_velocity_peak, s, select_greater(speed, peak, speed, peak))
        store(state.touching, s, contact_now)
    store(tally.contact_work, 0, work)
    return touched


@njit(**INLINE)
def update(modal, state, tally, force, in_contact, phase, free):
    """Advance the modes by one step under the row forces at its end and project what comes next:
    ``free`` (row, lane).
    """
    modes = modal.mode_start[-1]
    before, after = ((phase + RATIO - 1) % RATIO) * modes, phase * modes
    lost = load(tally.dissipated, 0)
    clear(free)
    for g in range(modal.mode_start.size - 1):
        if state.awake[g] == 0:
            continue
        first = modal.mode_start[g]
        width = modal.mode_start[g + 1] - first
        row0, row1 = modal.row_start[g], modal.row_start[g + 1]
        begin = row0 if in_contact else modal.force_row_start[g]
        for i in range(first, first + width, PANEL):
            at = modal.shape_start[g] + i - first
            f = panel_zero()
            for r in range(begin, row1):
                f = panel_plus_vector(modal.shapes, at + (r - row0) * width, load(force, r), f)
            q = panel_plus_scaled(modal.push, i, f, load_panel(state.ahead, i))
            moved = panel_difference(q, load_panel(state.displacement, before + i))
            lost = vector_plus_dot(modal.loss, i, panel_product(moved, moved), lost)
            store_panel(state.displacement, after + i, q)
            q = panel_plus_scaled(modal.shift, i, f, q)
            change = panel_plus_scaled(modal.kick, i, f, panel_zero())
            change = panel_plus_scaled(modal.decay, i, load_panel(state.change, i), change)
            change = panel_plus_scaled(modal.restore, i, q, change)
            store_panel(state.change, i, change)
            ahead = panel_sum(q, change)
            store_panel(state.ahead, i, ahead)
            project(modal, g, i, ahead, free)
    store(tally.dissipated, 0, lost)


@njit(**INLINE)
def average_modes(modal, state, output, tick):
    """Feed the modal displacements of the RATIO steps of a tick to the first stage of the output
    filter.
    """
    modes = modal.mode_start[-1]
    extras = state.average.size // (SLOTS * LANES)
    for g in range(modal.mode_start.size - 1):
        if state.awake[g] == 0:
            continue
        for slot in range(SLOTS):
            at = ((tick + slot) % SLOTS) * extras
            for i in range(modal.mode_start[g], modal.mode_start[g + 1], PANEL):
                total = load_panel(state.average, at + i)
                for phase in range(RATIO):
                    weight = spread(output.weights[phase, slot])
                    total = panel_plus_common(
                        weight, load_panel(state.displacement, phase * modes + i), total
                    )
                store_panel(state.average, at + i, total)


@njit(**INLINE)
def filter_forces(modal, state, output, resultants, drive, end, forces, touched, phase, tick):
    """Feed the supports' resultants and the drive forces (from vector ``end`` of drive) to the
    first filter stage.
    """
    extras = state.average.size // (SLOTS * LANES)
    for slot in range(SLOTS):
        a = ((tick + slot) % SLOTS) * extras + modal.mode_start[-1]
        w = spread(output.weights[phase, slot])
        if touched != 0:
            for c in range(2 * output.extra_support):
                store(state.average, a + c, fma(w, load(resultants, c), load(state.average, a + c)))
        a += 2 * output.extra_support
        for c in range(forces):
            store(state.average, a + c, fma(w, load(drive, end + c), load(state.average, a + c)))


@njit(**INLINE)
def project_channels(modal, g, output, array, base, entries, channels):
    """Add the modes of group g, in ``array`` from vector ``base`` on, to output channels, one block
    after the other of ``entries``.
    """
    first = modal.mode_start[g]
    width = modal.mode_start[g + 1] - first
    for e in range(entries[0], entries[1], CHANNEL_BLOCK):
        a, b, c, d = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
        at = output.shape_start[e]
        for i in range(0, width, PANEL):
            q = load_panel(array, base + first + i)
            a = vector_plus_dot(output.shapes, at + i, q, a)
            b = vector_plus_dot(output.shapes, at + width + i, q, b)
            c = vector_plus_dot(output.shapes, at + 2 * width + i, q, c)
            d = vector_plus_dot(output.shapes, at + 3 * width + i, q, d)
        store(channels, output.channel[e], load(channels, output.channel[e]) + a)
        store(channels, output.channel[e + 1], load(channels, output.channel[e + 1]) + b)
        store(channels, output.channel[e + 2], load(channels, output.channel[e + 2]) + c)
        store(channels, output.channel[e + 3], load(channels, output.channel[e + 3]) + d)


@njit(**INLINE)
def tally_stress(modal, state, tally, output, phase, channels):
    """Stresses at the end of the step, unfiltered: their statistics are not for the record's filter
    to take the impacts from.
    """
    sections, weight = tally.peak_square_stress.size // LANES, spread(output.stress_weight[phase])
    for c in range(output.stress_start, output.stress_start + 2 * sections):
        store(channels, c, spread(0.0))
    for g in range(modal.mode_start.size - 1):
        if state.awake[g] != 0:
            entries = (output.stress_entry[g], output.channel_start[g + 1])
            project_channels(
                modal,
                g,
                output,
                state.displacement,
                phase * modal.mode_start[-1],
                entries,
                channels,
            )
    for s in range(sections):
        s1 = load(channels, output.stress_start + 2 * s)
        s2 = load(channels, output.stress_start + 2 * s + 1)
        square = fma(s1, s1, s2 * s2)
        store(tally.square_stress, s, fma(weight, square, load(tally.square_stress, s)))
        store(tally.peak_square_stress, s, larger(square, load(tally.peak_square_stress, s)))


@njit(**INLINE)
def emit(modal, state, output, tick, at_tick, channels):
    """Finish the oldest output of the first stage: channels to output.values; clear it."""
    zero = spread(0.0)
    modes = modal.mode_start[-1]
    extras = state.average.size // (SLOTS * LANES)
    base = (tick % SLOTS) * extras
    column = output.column + at_tick
    clear(channels)
    for g in range(modal.mode_start.size - 1):
        if state.awake[g] == 0:
            continue
        project_channels(
            modal,
            g,
            output,
            state.average,
            base,
            (output.channel_start[g], output.stress_entry[g]),
            channels,
        )
    for c in range(output.stress_start):
        store(output.values, c * output.columns + column, load(channels, c))
    for x in range(extras - modes):
        store(
            output.values,
            (output.stress_start + x) * output.columns + column,
            load(state.average, base + modes + x),
        )
    for x in range(extras):
        store(state.average, base + x, zero)


@njit(**INLINE)
def keep_step(modal, contact, laws, state, trace, u, force, pull, quiet):
    """Make the end of the step the start of the next, and put it on the trace. quiet: no force,
    neither now nor before.
    """
    special = laws.point.size + laws.row.size > 0
    n = state.flag[1]
    for g in range(modal.row_start.size - 1):
        for r in range(modal.row_start[g], modal.force_row_start[g]):
            ur = load(u, r)
            if n < trace.steps:
                store(trace.displacement, r * trace.steps + n, ur)
                store(trace.force, r * trace.steps + n, load(force, r))
            if special:
                moved = ur - load(state.row_displacement, r)
                memory = spread(modal.speed[3]) * load(state.row_velocity, r)
                store(state.row_velocity, r, fma(spread(modal.speed[2]), moved, memory))
            store(state.row_displacement, r, ur)
            if not quiet:
                store(state.row_force_before, r, load(state.row_force, r))
                store(state.row_force, r, load(force, r))
                store(state.row_pull_before, r, load(state.row_pull, r))
                store(state.row_pull, r, load(pull, r))


@njit(**INLINE)
def within_limit(modal, contact, state, tally):
    """Sum the squares of the rows; False when one is lost: beyond the limit, or not a number."""
    zero, one, half, limit = spread(0.0), spread(1.0), spread(0.5), spread(contact.limit)
    lost = zero
    for g in range(modal.row_start.size - 1):
        for r in range(modal.row_start[g], modal.force_row_start[g]):
            u = load(state.row_displacement, r)
            store(tally.square_displacement, r, fma(u, u, load(tally.square_displacement, r)))
            lost = lost + select_greater(limit, magnitude(u), zero, one)
    return not any_greater(lost, half)


@njit(**COMPILED)
def march(modal, contact, laws, state, tally, output, trace, work, drive):
    """Integrate whole ticks of RATIO steps; ``drive`` (step, force_channel, lane) N: the force at
    the end of every step.

    One linear step per mode (schemes.py), contacts and elements implicit. Fills output.values (one
    column per tick: the filter output centred BEHIND ticks before), adds to ``tally`` and advances
    ``state`` in place. Returns the number of steps done; fewer than asked means that the run
    diverged there.
    """
    mode = flush_subnormals()
    forces = drive.shape[1]
    free = work.free
    u = work.displacement
    force = work.force
    pull = work.pull
    resultant = work.resultant
    special = laws.point.size + laws.row.size > 0
    project_ahead(modal, state, free)
    for at_tick in range(drive.shape[0] // RATIO):
        tick = state.flag[1] // RATIO
        for phase in range(RATIO):
            n = at_tick * RATIO + phase
            apply_drive(modal, drive, n, forces, force, free)
            if special:
                active = solve_laws(contact, laws, modal, state, tally, work)
            else:
                active = solve_contact(contact, modal, state, tally, free, u, force, pull)
            quiet = not special and not active and state.flag[0] >= QUIET
            touched = 0
            if active or state.flag[0] == 0:
                touched = tally_contact(modal, contact, state, tally, u, force, resultant)
                if special:
                    tally_laws(modal, contact, laws, state, tally, work)
                    if laws.row.size > 0:
                        touched = 1
            if active:
                state.awake[:] = 1
            tally_drive(modal, state, tally, free, force, active)
            if quiet:
                keep_step(modal, contact, laws, state, trace, free, force, pull, True)
            else:
                keep_step(modal, contact, laws, state, trace, u, force, pull, False)
            update(modal, state, tally, force, active, phase, free)
            if output.stress_weight[phase] > 0.0:
                tally_stress(modal, state, tally, output, phase, work.channels)
            filter_forces(
                modal, state, output, resultant, drive, n * forces, forces, touched, phase, tick
            )
            state.flag[0] = 0 if touched != 0 else min(state.flag[0] + 1, QUIET)
            state.flag[1] += 1
        if not within_limit(modal, contact, state, tally):
            restore_mode(mode)
            return (at_tick + 1) * RATIO
        average_modes(modal, state, output, tick)
        emit(modal, state, output, tick, at_tick, work.channels)
    restore_mode(mode)
    return drive.shape[0]


@njit(**COMPILED)
def decimate(values, taps, out, out_start, step, buffer):
    """Second stage of the output filter, lane by lane, four samples at a time.

    ``values`` (channel, tick, lane) flat with ``taps.size - 1`` ticks of history in front; ``taps``
    padded with 3 step zeros at both ends; ``out`` (lane, channel, sample) receives sample j = sum
    of taps times values from tick j * step on, at ``out_start + j``; buffer (4, lane).
    """
    lanes, channels, _ = out.shape
    ticks = values.size // (channels * LANES)
    length = taps.size - 6 * step
    count = (ticks - length) // step + 1
    for c in range(channels):
        for j in range(0, count, 4):
            at = c * ticks + j * step
            a, b, d, e = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
            for k in range(min(length + 3 * step, ticks - j * step)):
                value = load(values, at + k)
                a = fma(spread_from(taps, k + 3 * step), value, a)
                b = fma(spread_from(taps, k + 2 * step), value, b)
                d = fma(spread_from(taps, k + step), value, d)
                e = fma(spread_from(taps, k), value, e)
            store(buffer, 0, a)
            store(buffer, 1, b)
            store(buffer, 2, d)
            store(buffer, 3, e)
            for m in range(min(4, count - j)):
                for lane in range(lanes):
                    out[lane, c, out_start + j + m] = buffer[m, lane]
