"""vibroimpact: vibration of tubes and other structures with gap supports, and the linear support
that is equivalent to them.

The names of `vibroimpact.__all__` are the interface for notebooks and scripts of users. Each is
imported when it is first used. Modules of the library and scripts of the workflow import from the
modules themselves, so that the workflow sees which files a stage depends on.
"""

import re
from importlib import import_module
from pathlib import Path

__version__ = "0.4.0"

# Name -> module that defines it, as __init__.pyi states for type checkers.
STUB = Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")
PUBLIC = {name: module for module, name in re.findall(r"from \.(\S+) import (\w+) as", STUB)}
__all__ = ["__version__", *PUBLIC]


def __getattr__(name):
    """Return a public name, imported from its module. Raises AttributeError for any other name."""
    if name not in PUBLIC:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    value = getattr(import_module(f"{__name__}.{PUBLIC[name]}"), name)
    globals()[name] = value
    return value


def __dir__():
    """Return the public names."""
    return sorted(__all__)
