"""The wear life of a finished study, from its folder.

It reads and checks a configuration; `life` does not, so that no page depends on these checks.
"""

from pathlib import Path

from vibroimpact.config.reading import load_config
from vibroimpact.config.wear import Wear
from vibroimpact.study.own_results import usable_records
from vibroimpact.study.run_files import CONFIG_FILE

from .life import NoWear, WearRow, wear_rows


def wear_life(folder: str | Path, wear: Wear) -> list[WearRow]:
    """Return the WearRows of a study's folder.

    Raises NoWear, ConfigError, and RecordError if a record is missing or of another configuration
    than config.yaml there.
    """
    folder = Path(folder)
    if not any((folder / "records").glob("*.nc")):
        raise NoWear(f"{folder / 'records'}: there are no records: give the results of a study")
    config = load_config(folder / CONFIG_FILE)
    return wear_rows(config, usable_records(folder, config), wear)
