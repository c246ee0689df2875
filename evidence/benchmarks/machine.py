"""What the times were taken on: processor, caches, and the versions of what compiles."""

import os
import platform
from importlib.metadata import version
from pathlib import Path

import llvmlite.binding

VECTORS = ("avx512f", "avx2", "fma", "neon", "sve")


def description(cores, peak_GFLOPs, vector_bits):
    """Return {what: value}, in words; no name of the host. cores: those the benchmark may use."""
    features = llvmlite.binding.get_host_cpu_features()
    return {
        "processor": _processor(),
        "cores used": f"{len(cores)} (every time but the last table's was taken on one)",
        "caches": ", ".join(_caches()) or "unknown",
        "vector instructions": (
            ", ".join(name for name in VECTORS if features.get(name)) or "unknown"
        ),
        "fused multiply-adds": (
            f"{peak_GFLOPs:.1f} GFLOP/s float64 on one core, measured with vectors of {vector_bits}"
            " bits"
        ),
        "operating system": f"{platform.system()} {platform.machine()}",
        "Python, NumPy, SciPy": (
            f"{platform.python_version()}, {version('numpy')}, {version('scipy')}"
        ),
        "compiler": (
            f"numba {version('numba')}, llvmlite {version('llvmlite')}, LLVM"
            f" {'.'.join(map(str, llvmlite.binding.llvm_version_info))}, target"
            f" {llvmlite.binding.get_host_cpu_name()}"
        ),
    }


def allowed_cores():
    """Return the numbers of the cores that this process may use."""
    return (
        sorted(os.sched_getaffinity(0))
        if hasattr(os, "sched_getaffinity")
        else list(range(os.cpu_count() or 1))
    )


def _processor():
    """Return the processor's own name."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def _caches():
    """Return the caches that the first core sees, like "L1d 32K"."""
    found = []
    for folder in sorted(Path("/sys/devices/system/cpu/cpu0/cache").glob("index*")):
        try:
            level, kind, size = (
                (folder / name).read_text(encoding="ascii").strip()
                for name in ("level", "type", "size")
            )
        except OSError:
            continue
        found.append(f"L{level}{'' if kind == 'Unified' else kind[0].lower()} {size}")
    return found
