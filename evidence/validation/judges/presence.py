"""Import of the other codes, each only when it is used.

Where one is not installed, a sentence says how to install it.
"""

import logging
import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

PYTHON_JUDGES = "requirements-judges.lock of the repository lists what to install"


class JudgeAbsent(Exception):
    """A judge that is not installed; the message says how to install it."""


def opensees():
    """Return the module openseespy.opensees. Raises JudgeAbsent."""
    try:
        import openseespy.opensees as module
    except (ImportError, RuntimeError) as error:
        # RuntimeError: its compiled part does not fit this version of Python
        raise JudgeAbsent(
            f"OpenSeesPy cannot be imported ({error}): {PYTHON_JUDGES}; its compiled part needs"
            " Python 3.11 on Linux"
        ) from error
    return module


def sdypy_ema():
    """Return the module sdypy.EMA. Raises JudgeAbsent."""
    try:
        from sdypy import EMA as module
    except ImportError as error:
        raise JudgeAbsent(f"sdypy-EMA cannot be imported ({error}): {PYTHON_JUDGES}") from error
    return module


def pyoma2():
    """Return the modules (pyoma2.functions.ssi, pyoma2.functions.plscf). Raises JudgeAbsent."""
    try:
        with np.errstate():  # its import switches off numpy's floating-point warnings for good
            from pyoma2.functions import plscf, ssi
    except ImportError as error:
        raise JudgeAbsent(f"pyOMA2 cannot be imported ({error}): {PYTHON_JUDGES}") from error
    logging.getLogger("pyoma2").setLevel(logging.WARNING)  # it logs every record it works on
    return ssi, plscf


def calculix(deck):
    """Return the text of the .dat file that CalculiX writes for an input deck.

    Raises JudgeAbsent; RuntimeError when CalculiX fails.
    """
    program = shutil.which("ccx")
    if program is None:
        raise JudgeAbsent(
            "CalculiX is not on the PATH as ccx: apt-get install calculix-ccx, or another build of"
            " CalculiX 2.20"
        )
    with TemporaryDirectory() as folder:
        Path(folder, "tube.inp").write_text(deck, encoding="ascii")
        done = subprocess.run(
            [program, "-i", "tube"], cwd=folder, capture_output=True, text=True, check=False
        )
        if done.returncode or "*ERROR" in done.stdout:
            raise RuntimeError(
                f"ccx ended with {done.returncode}: {(done.stdout + done.stderr)[-600:]}"
            )
        return Path(folder, "tube.dat").read_text(encoding="ascii")
