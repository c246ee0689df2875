"""The place of the workflow and its configurations: in the installed package, or in a checkout."""

from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[2]


def shared_folder() -> Path:
    """Return the folder that holds Snakefile, workflow/, config/ and examples/.

    It is vibroimpact/share of an installed package, and the repository of a checkout or of an
    editable installation.
    Raises FileNotFoundError if there is neither; the message tells how to install.
    """
    places = (PACKAGE / "share", PACKAGE.parents[1])
    for folder in places:
        if (folder / "Snakefile").is_file() and (folder / "workflow" / "rules").is_dir():
            return folder
    raise FileNotFoundError(
        f"no workflow in {' or '.join(map(str, places))}: this copy of vibroimpact is not complete;"
        " install it again from its wheel, its source archive or a clone"
    )


def workflow_snakefile() -> str:
    """Return the path of the workflow's Snakefile, to be included by that of a study."""
    return str(shared_folder() / "Snakefile")


def configurations() -> dict[str, Path]:
    """Return {name: file} of the configurations that a study can start from.

    They are those of config/ and of config/examples/, named after their files, study first.
    """
    config = shared_folder() / "config"
    files = sorted([*config.glob("*.yaml"), *config.glob("examples/*.yaml")])
    found = {file.stem: file for file in files}
    return {"study": found.pop("study"), **found}
