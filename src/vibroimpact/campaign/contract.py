"""The contract of a campaign file: variables, dimensions, types. See campaign/file.py for the list.

Their allowed values are in campaign/stated_values.py. A problem is a sentence that begins with
the variable or attribute, without the file's name.
"""

from __future__ import annotations

from collections.abc import Iterator

import xarray as xr

from .stated_values import stated_value_problems

NEEDED = {
    "force": ("record", "force_channel", "time"),
    "response": ("record", "channel", "time"),
    "channel_units": ("channel",),
    "channel_kind": ("channel",),
    "channel_name": ("channel",),
    "channel_point": ("channel", "xyz"),
    "channel_direction": ("channel", "xyz"),
    "force_channel_name": ("force_channel",),
    "force_channel_point": ("force_channel", "xyz"),
    "force_channel_direction": ("force_channel", "xyz"),
    "gap": ("record",),
}
# Derived from the rest if they are missing.
FILLED = {
    "record_name": ("record",),
    "load_rms": ("record",),
    "repeat": ("record",),
    "split": ("record",),
}
OPTIONAL = {
    "support_gap": ("record", "support"),
    "voltage": ("record", "time"),
    "noise_floor_rms": ("channel",),
    "valid_samples": ("record",),
    "force_channel_units": ("force_channel",),
    "force_channel_kind": ("force_channel",),
    "time": ("time",),
}
TEXTS = (
    "channel_units",
    "channel_kind",
    "channel_name",
    "force_channel_name",
    "force_channel_units",
    "force_channel_kind",
    "record_name",
    "split",
)
# Their values are read only after the file is known to be sound.
SERIES = ("force", "response", "voltage")
SEE = "see docs/bring_your_own.md"
NO_FORCE = (
    "holds no force: there is no verdict on a model; k and c of the supports can be"
    " read, see docs/measured_supports.md"
)


def contract_problems(campaign: xr.Dataset, force_needed: bool = True) -> Iterator[str]:
    """Yield a sentence for every breach of the contract by a Dataset with decoded texts.

    force_needed: whether there must be a force channel.

    The values of SERIES are not looked at: the fault in them concerns single signals.
    """
    sound = set()
    forms = NEEDED | FILLED | OPTIONAL
    if force_needed and not any(str(name).startswith("force") for name in campaign.variables):
        yield NO_FORCE
        forms = {name: dims for name, dims in forms.items() if not name.startswith("force")}
    for name, dims in forms.items():
        problem = _form_problem(campaign, name, dims)
        if problem:
            yield problem
        elif name in campaign.variables:
            sound.add(name)
    yield from _size_problems(campaign, force_needed)
    yield from stated_value_problems(campaign, sound)


def _form_problem(campaign: xr.Dataset, name: str, dims: tuple[str, ...]) -> str | None:
    """Return a sentence about a variable that is missing, or of another form, else None."""
    if name not in campaign.variables:
        return f"has no variable '{name}' {dims}: {SEE}" if name in NEEDED else None
    variable = campaign[name]
    if variable.dims != dims:
        return f"'{name}' has dimensions {variable.dims}, expected {dims}"
    if name in TEXTS:
        return None if variable.dtype.kind == "O" else f"'{name}' holds numbers: write texts"
    if variable.dtype.kind not in "fiu":
        what = "texts" if variable.dtype.kind == "O" else f"values of type {variable.dtype}"
        return f"'{name}' holds {what}: write numbers"
    return None


def _size_problems(campaign: xr.Dataset, force_needed: bool) -> Iterator[str]:
    """Yield a sentence for every dimension that is empty, or has no room for its meaning."""
    for dim in ("record", "channel", *(["force_channel"] if force_needed else []), "time"):
        if campaign.sizes.get(dim, 1) < 1:
            yield f"the dimension {dim} is empty: write one {dim} at least"
    if campaign.sizes.get("xyz", 3) != 3:
        yield f"the dimension xyz has the length {campaign.sizes['xyz']}: it must be 3"
