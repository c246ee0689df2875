"""Whether results are of the configuration in their folder: a killed run leaves older ones."""

from pathlib import Path
from typing import Any

from vibroimpact.config.schema import Config
from vibroimpact.config.stage_keys import stage_params
from vibroimpact.io.provenance import config_digest
from vibroimpact.io.records import RecordError, read_attributes

from .cases import all_cases
from .run_files import CONFIG_FILE, PROVENANCE_FILE

# Global attributes of a record: the digests of its simulation, and of its model.
SIMULATED, MODEL_DIGEST = "config_digest", "model_digest"
SIMULATING = ("simulate", "simulate_to_spectra")  # one of these stages makes the records


def other_configuration(path: Path, beside: Path) -> str:
    """Return the sentence for a result of another configuration than that of its folder."""
    return f"{path}: is of another configuration than {beside}, {_remedy(beside)}"


def _remedy(beside: Path) -> str:
    return (
        "whose run did not come to its end: run the command in"
        f" {beside.with_name(PROVENANCE_FILE)} to the end first"
    )


def model_attributes(path: str | Path) -> dict[str, Any]:
    """Return the attributes of a record that say which model.nc it is of. Raises RecordError."""
    return {MODEL_DIGEST: read_attributes(path).get(SIMULATED, "")}


def usable_records(folder: Path, config: Config) -> list[Path]:
    """Return the records of the cases of a study, in the order of its grid.

    Files of cases that the grid does not have are left out.

    config: that of the folder. Raises RecordError if a record is missing, or is of another
    configuration.
    """
    paths = [folder / "records" / f"{case.id}.nc" for case in all_cases(config.grid)]
    missing = [path for path in paths if not path.is_file()]
    if missing:
        raise RecordError(
            f"{missing[0]}: is missing, one of {len(missing)} of the {len(paths)} records that"
            f" {folder / CONFIG_FILE} asks for, {_remedy(folder / CONFIG_FILE)}"
        )
    simulated = {config_digest(stage_params(config, stage)) for stage in SIMULATING}
    model = config_digest(stage_params(config, "basis"))
    for path in paths:
        found = read_attributes(path)
        if found.get(SIMULATED) not in simulated or found.get(MODEL_DIGEST) != model:
            raise RecordError(other_configuration(path, folder / CONFIG_FILE))
    return paths
