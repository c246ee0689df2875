"""The kernel on a machine without 512-bit vectors, by forcing it: the same bits."""

import os
import platform
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from llvmlite import binding
from numba.core.registry import cpu_target

from vibroimpact.config.reading import changed_config, load_config
from vibroimpact.integration.batch import Schedule, integrate_batch
from vibroimpact.integration.kernels.lanes import LANES
from vibroimpact.integration.kernels.march import march
from vibroimpact.reduction.reduced_model import build_model

CONFIG = Path(__file__).resolve().parents[2] / "config" / "study.yaml"
SMALL = {
    "basis.free_modes_to_Hz": 1000.0,
    "basis.constrained_modes_to_Hz": 500.0,
    "structure.mesh.elements_per_bend": 20,
}
NARROW = {
    "NUMBA_CPU_NAME": "haswell",
    "NUMBA_CPU_FEATURES": "",
}  # AVX2 and fused multiply-add, vectors of 256 bits


def short_run():
    """All that a short run with impacts leaves behind: {name: array}."""
    force = 200.0 * np.random.default_rng(0).standard_normal((2000, 1, LANES))
    gap = np.linspace(2e-5, 4e-5, LANES)
    offset = 0.05 * gap * np.random.default_rng(1).uniform(-1.0, 1.0, (10, 2, LANES))
    lanes = integrate_batch(
        build_model(changed_config(load_config(CONFIG), SMALL)),
        Schedule(20480, 2048, 0.0, 0.02, "exact"),
        gap,
        offset,
        lambda first, count: force[first : first + count],
    )
    return {
        "displacement": lanes.displacement,
        "acceleration": lanes.acceleration,
        "force": lanes.force,
        "energy": lanes.energy,
        **lanes.tally,
    }


def main(path):
    """Save a short run, the processor that numba compiled for, and whether what was compiled names
    a 512-bit register.
    """
    found = short_run()
    fresh = not march.stats.cache_hits  # what comes out of the cache has no listing
    wide = fresh and "zmm" in "".join(march.inspect_asm().values())
    np.savez(
        path, processor=cpu_target.target_context.codegen().magic_tuple()[1], wide=wide, **found
    )


def host_can():
    """Whether this processor runs what is compiled for Haswell."""
    features = binding.get_host_cpu_features()
    return (
        platform.machine() in ("x86_64", "AMD64") and features.get("avx2") and features.get("fma")
    )


@pytest.mark.slow
@pytest.mark.skipif(
    not host_can(), reason="needs an x86 processor with AVX2 and fused multiply-add"
)
def test_narrow_vectors_give_the_same_bits(tmp_path, cache):
    """Compiled for AVX2 in a process of its own, kept in pytest's cache for the next time."""
    path = os.pathsep.join(str(Path(entry).resolve()) for entry in sys.path)
    environment = {
        **os.environ,
        **NARROW,
        "NUMBA_CACHE_DIR": str(cache.mkdir("narrow_vectors")),
        "PYTHONPATH": path,
    }
    subprocess.run([sys.executable, __file__, tmp_path / "narrow.npz"], env=environment, check=True)
    narrow, here = np.load(tmp_path / "narrow.npz"), short_run()
    assert narrow["processor"] == NARROW["NUMBA_CPU_NAME"] and not narrow["wide"]
    assert here["impacts"].min() > 0
    assert here["residual"].min() > 0.0
    for name, values in here.items():
        assert np.array_equal(values, narrow[name]), name


if __name__ == "__main__":
    main(sys.argv[1])
