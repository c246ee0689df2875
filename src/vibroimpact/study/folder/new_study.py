"""Lay out a folder for a study of one's own: its configuration, Snakefile, profiles and README."""

import os
import shutil
from collections.abc import Iterator
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from vibroimpact import __version__
from vibroimpact.config.yaml_file import read_yaml

from .shared_files import configurations, shared_folder

TEMPLATE = Path(__file__).with_name("template")
CONFIGURATION = Path("config", "study.yaml")  # the file that the Snakefile reads by itself


class NewStudyError(ValueError):
    """A folder that can not be laid out. The message states the reason and the remedy."""


def new_study(folder: Path | str, example: str = "study") -> list[Path]:
    """Return the files laid out in a folder for a study, by their paths below it, sorted.

    folder: is made if it does not exist. Nothing that exists is overwritten.
    example: the configuration to start from, one of shared_files.configurations. Files that it
        names, such as matrices, are copied with it.
    Raises NewStudyError for a folder that is not empty, an example that does not exist, and a
    folder that can not be written.
    """
    folder = Path(folder)
    _refuse_what_exists(folder)
    source = _configuration(example)
    shared, data = shared_folder(), read_yaml(source)
    copies = {CONFIGURATION: source}
    copies |= {named: shared / named for named in files_named(data, shared)}
    profiles = shared / "workflow" / "profiles"
    for profile in sorted(profiles.glob("*/config.yaml")):
        copies[Path("profiles", profile.relative_to(profiles))] = profile
    readme = (TEMPLATE / "README.md").read_text(encoding="utf-8")
    for name, value in {"version": __version__, "example": example, "study": data["study"]}.items():
        readme = readme.replace(f"{{{name}}}", str(value))
    try:
        for target, origin in (
            *copies.items(),
            (Path("Snakefile"), TEMPLATE / "Snakefile"),
            (Path(".gitignore"), TEMPLATE / "gitignore"),
        ):
            (folder / target).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(origin, folder / target)
        (folder / "README.md").write_text(readme, encoding="utf-8")
    except OSError as error:
        raise NewStudyError(f"{folder} can not be written: {error}") from error
    return sorted(file.relative_to(folder) for file in folder.rglob("*") if file.is_file())


def files_named(value: Any, folder: Path) -> Iterator[Path]:
    """Yield the relative paths that stand as values in a configuration and are files of a folder.

    value: a mapping, a list or a single value, as YAML gives it.
    """
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        for item in value:
            yield from files_named(item, folder)
    elif isinstance(value, str) and not Path(value).is_absolute() and (folder / value).is_file():
        yield Path(value)


def _refuse_what_exists(folder: Path) -> None:
    """Raise NewStudyError if a path is a file or a folder that holds something."""
    if os.path.exists(folder) and not os.path.isdir(folder):
        raise NewStudyError(f"{folder} is a file: give a folder that does not exist yet")
    if os.path.isdir(folder) and (entry := next(folder.iterdir(), None)):
        raise NewStudyError(
            f"{folder} is not empty, it holds {entry.name}: give a folder that is empty or does not"
            " exist yet"
        )


def _configuration(example: str) -> Path:
    """Return the file of a configuration. Raises NewStudyError that lists them for any other."""
    known = configurations()
    if example in known:
        return known[example]
    meant = get_close_matches(example, known, 1)
    raise NewStudyError(
        f"there is no example '{example}'{f', did you mean {meant[0]}?' if meant else '.'}"
        f" There are: {', '.join(known)}"
    )
