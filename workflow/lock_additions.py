"""Rewrite a lock to what it adds: `python workflow/lock_additions.py requirements-docs.lock`.

Takes out the packages that requirements.lock pins, and names that file at the top in their place.
"""

import re
import sys
from pathlib import Path

BASE = "requirements.lock"


def entries(lock: Path) -> dict[str, str]:
    """Return {package==version: its lines} of a lock."""
    text = lock.read_text(encoding="utf-8")
    found = re.findall(r"^(\S+==\S+)(.*\n(?:[ ].*\n)*)", text, re.M)
    return {pin: pin + rest for pin, rest in found}


def additions(lock: Path) -> str:
    """Return the text of a lock without the packages of the base. Raises ValueError where a version
    is not that of the base.
    """
    base, own = entries(lock.with_name(BASE)), entries(lock)
    names = {pin.split("==")[0] for pin in base}
    added = {pin: text for pin, text in own.items() if pin not in base}
    other = [pin for pin in added if pin.split("==")[0] in names]
    if other:
        raise ValueError(f"{lock.name}: {', '.join(other)} has another version in {BASE}")
    return f"-r {BASE}\n" + "".join(added.values())


if __name__ == "__main__":
    path = Path(sys.argv[1])
    path.write_text(additions(path), encoding="utf-8")
