"""The processor's treatment of subnormal numbers, below 1e-308."""

import platform

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from .lanes import INT32

_X86 = platform.machine().lower() in ("x86_64", "amd64", "i686")
_FLUSH = 0x8040  # flush-to-zero and denormals-are-zero of the MXCSR register


@intrinsic
def flush_subnormals(typing_context):
    """Treat subnormal numbers as zero in this thread; returns the mode before, for `restore_mode`.

    A motion that decays freely passes through them, and arithmetic on them is many times slower:
    without this, records with rare contacts take three times as long as others. Processors other
    than x86 keep them.
    """

    def code(context, builder, sig, args):
        if not _X86:
            return ir.Constant(INT32, 0)
        slot = cgutils.alloca_once(builder, INT32)
        before = _mode(builder, slot, "st")
        builder.store(builder.or_(before, ir.Constant(INT32, _FLUSH)), slot)
        _mode(builder, slot, "ld")
        return before

    return types.int32(), code


@intrinsic
def restore_mode(typing_context, before):
    """Undo `flush_subnormals`."""

    def code(context, builder, sig, args):
        if _X86:
            slot = cgutils.alloca_once(builder, INT32)
            builder.store(args[0], slot)
            _mode(builder, slot, "ld")
        return context.get_dummy_value()

    return types.void(types.int32), code


def _mode(builder, slot, direction):
    """Code that stores ("st") the MXCSR register to a slot or loads ("ld") it from there."""
    pointer = ir.IntType(8).as_pointer()
    kind = ir.FunctionType(ir.VoidType(), [pointer])
    builder.call(
        cgutils.get_or_insert_function(builder.module, kind, f"llvm.x86.sse.{direction}mxcsr"),
        [builder.bitcast(slot, pointer)],
    )
    return builder.load(slot)
