"""The contract of a campaign file: variables, dimensions, types. See campaign/file.py for the list.

Their allowed values are in campaign/stated_values.py. A problem is a sentence that begins with
the variable or attribute, without the file's name.
"""

from collections.abc import Iterator

import xarray as xr

from .stated_values import stated_value_problems

NEEDED, FILLED, OPTIONAL = "needed", "derived from the rest if it is missing", "optional"
# {(need, dimensions): {name: (unit if the file states none, long name)}} of the variables.
# The unit is "" for several or none, None for texts.
DECLARED: dict[tuple[str, str], dict[str, tuple[str | None, str]]] = {
    (NEEDED, "record force_channel time"): {"force": ("", "excitation force of the record")},
    (NEEDED, "record channel time"): {
        "response": ("", "response of the record, in the unit of its channel")
    },
    (NEEDED, "channel"): {
        "channel_units": (None, "unit of the channel"),
        "channel_kind": (None, "quantity that the channel measures"),
        "channel_name": (None, "name of the channel"),
    },
    (NEEDED, "channel xyz"): {
        "channel_point": ("m", "position of the channel"),
        "channel_direction": ("1", "unit vector of the positive sense of the channel"),
    },
    (NEEDED, "force_channel"): {"force_channel_name": (None, "name of the force channel")},
    (NEEDED, "force_channel xyz"): {
        "force_channel_point": ("m", "position of the force"),
        "force_channel_direction": ("1", "unit vector of the positive sense of the force"),
    },
    (NEEDED, "record"): {"gap": ("m", "radial gap of the record")},
    (FILLED, "record"): {
        "record_name": (None, "name of the record"),
        "load_rms": ("N", "RMS of the force of channel 0 about its mean, over the valid samples"),
        "repeat": ("1", "number of the record among those of the same load and gap, from 0"),
        "split": (None, "use of the record: fit or holdout"),
    },
    (OPTIONAL, "record support"): {"support_gap": ("m", "radial gap of the support")},
    (OPTIONAL, "record time"): {"voltage": ("V", "voltage of the shaker")},
    (OPTIONAL, "channel"): {"noise_floor_rms": ("", "RMS of the channel's noise, in its unit")},
    (OPTIONAL, "record"): {
        "valid_samples": ("1", "number of samples of the record that count, from its start")
    },
    (OPTIONAL, "force_channel"): {
        "force_channel_units": (None, "unit of the force channel"),
        "force_channel_kind": (None, "what the force channel measures: a force, or the base"),
    },
    (OPTIONAL, "time"): {"time": ("s", "time since the start of the record")},
}
DIMENSIONS = {name: tuple(dims.split()) for (_, dims), row in DECLARED.items() for name in row}
ABOUT = {name: about for row in DECLARED.values() for name, about in row.items()}
REQUIRED = {name for (need, _), row in DECLARED.items() if need == NEEDED for name in row}
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
    forms = DIMENSIONS
    if force_needed and not any(str(name).startswith("force") for name in campaign.variables):
        yield NO_FORCE
        forms = {name: dims for name, dims in forms.items() if not name.startswith("force")}
    for name, dims in forms.items():
        problem = _form_problem(campaign, name, dims)
        if problem:
            yield problem
        elif name in campaign.variables:
            sound.add(name)
    for dim in ("record", "channel", *(["force_channel"] if force_needed else []), "time"):
        if campaign.sizes.get(dim, 1) < 1:
            yield f"the dimension {dim} is empty: write one {dim} at least"
    if campaign.sizes.get("xyz", 3) != 3:
        yield f"the dimension xyz has the length {campaign.sizes['xyz']}: it must be 3"
    yield from stated_value_problems(campaign, sound)


def _form_problem(campaign: xr.Dataset, name: str, dims: tuple[str, ...]) -> str | None:
    """Return a sentence about a variable that is missing, or of another form, else None."""
    if name not in campaign.variables:
        return f"has no variable '{name}' {dims}: {SEE}" if name in REQUIRED else None
    variable = campaign[name]
    if variable.dims != dims:
        return f"'{name}' has dimensions {variable.dims}, expected {dims}"
    if ABOUT[name][0] is None:
        return None if variable.dtype.kind == "O" else f"'{name}' holds numbers: write texts"
    if variable.dtype.kind not in "fiu":
        what = "texts" if variable.dtype.kind == "O" else f"values of type {variable.dtype}"
        return f"'{name}' holds {what}: write numbers"
    return None
