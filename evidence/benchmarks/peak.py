"""What one core can do at most: its rate of fused multiply-adds, measured, and the arithmetic that
a step of the tube asks for.
"""

import ctypes

from llvmlite import binding, ir

FMAS = 2**29  # vector instructions per measurement: tenths of a second
PASSES = (
    2  # of the contact fixed point beyond the first, which needs no product with the compliance
)
LAW_FLOPS = 20  # of a contact point in one pass: distance, root, force


class PeakRate:
    """A loop of independent fused multiply-adds in registers, compiled for this machine.

    flops: floating-point operations of one call of run(); vector_bits: width of its vectors.
    """

    def __init__(self):
        binding.initialize_native_target()
        binding.initialize_native_asmprinter()
        features = binding.get_host_cpu_features()
        wide = bool(features.get("avx512f"))
        # Enough chains to hide the latency of two units, few enough to stay in the registers.
        lanes, chains = (8, 24) if wide else (4, 12)
        self.vector_bits = 64 * lanes
        rounds = FMAS // chains
        self.flops = 2 * lanes * chains * rounds
        self._engine = _compile(_loop(lanes, chains), features)
        self._call = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_int64, ctypes.c_double)(
            self._engine.get_function_address("peak")
        )
        self._rounds = rounds

    def run(self):
        """Do the operations; the result, which nobody needs, keeps them from being left out."""
        return self._call(self._rounds, 0.5)


def _loop(lanes, chains):
    """Return the module of double peak(rounds, factor): `chains` accumulators a = a factor +
    factor, `rounds` times.
    """
    module, double, integer = ir.Module(), ir.DoubleType(), ir.IntType(64)
    vector = ir.VectorType(double, lanes)
    function = ir.Function(module, ir.FunctionType(double, [integer, double]), "peak")
    fma = ir.Function(module, ir.FunctionType(vector, [vector] * 3), f"llvm.fma.v{lanes}f64")
    entry, body, end = (function.append_basic_block(name) for name in ("entry", "body", "end"))
    builder = ir.IRBuilder(entry)
    one = builder.insert_element(
        ir.Constant(vector, ir.Undefined), function.args[1], ir.Constant(ir.IntType(32), 0)
    )
    factor = builder.shuffle_vector(
        one, one, ir.Constant(ir.VectorType(ir.IntType(32), lanes), [0] * lanes)
    )
    builder.branch(body)
    builder.position_at_end(body)
    count = builder.phi(integer)
    sums = [builder.phi(vector) for _ in range(chains)]
    moved = [builder.call(fma, [total, factor, factor]) for total in sums]
    after = builder.add(count, ir.Constant(integer, 1))
    for chain, (total, new) in enumerate(zip(sums, moved, strict=True)):
        total.add_incoming(ir.Constant(vector, [float(chain)] * lanes), entry)
        total.add_incoming(new, body)
    count.add_incoming(ir.Constant(integer, 0), entry)
    count.add_incoming(after, body)
    builder.cbranch(builder.icmp_signed("<", after, function.args[0]), body, end)
    builder.position_at_end(end)
    total = moved[0]
    for new in moved[1:]:
        total = builder.fadd(total, new)
    builder.ret(builder.extract_element(total, ir.Constant(ir.IntType(32), 0)))
    return module


def _compile(module, features):
    """Return the execution engine of a module, for the processor it runs on."""
    parsed = binding.parse_assembly(str(module))
    target = binding.Target.from_default_triple()
    machine = target.create_target_machine(
        cpu=binding.get_host_cpu_name(), features=features.flatten(), opt=2
    )
    engine = binding.create_mcjit_compiler(parsed, machine)
    engine.finalize_object()
    return engine


def flops_per_step(model, touching=True):
    """Return the floating-point operations that one step of a ModalModel asks for, statistics and
    output filter not counted.

    Of each group of modes that contacts couple (m modes, r contact rows): prediction 12 m,
    displacement of the rows 2 m r, correction 5 m; in contact also forces back to the modes 2 m r
    and PASSES products with the compliance 4 r² in all, and at each contact point LAW_FLOPS in each
    pass. For 60 modes in two planes of 10 rows this is 4820; 8020 if the planes were not separated.
    """
    total = 0
    for modes, contacts in model.blocks:
        m, r = len(modes), len(contacts)
        total += 17 * m + 2 * m * r + (2 * m * r + 2 * PASSES * r * r if touching else 0)
    return total + (LAW_FLOPS * (PASSES + 1) * len(model.support_of_point) if touching else 0)
