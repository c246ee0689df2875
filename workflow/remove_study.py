"""Remove the results of one study: `make clean STUDY=name`. What was imported stays."""

import shutil
import sys
from pathlib import Path

RESULTS = Path(__file__).resolve().parents[1] / "results"
IMPORT_REPORT = "import.txt"  # lies beside a campaign that was imported


def remove_study(name: str, results: Path = RESULTS) -> str:
    """Remove results/<name> and return a sentence that says what was removed.

    A campaign imported into the folder stays, with the report of its import.
    Raises ValueError where there is no such folder directly inside the results.
    """
    known = sorted(folder.name for folder in results.iterdir() if folder.is_dir())
    if name not in known:
        raise ValueError(
            f"STUDY = '{name}' is not in {results.name}/, which holds {', '.join(known) or 'none'}:"
            " make clean STUDY=name"
        )
    folder = results / name
    if folder.is_symlink():
        raise ValueError(f"{folder} is a link: remove it by hand")
    stays = set()
    if (folder / IMPORT_REPORT).exists():
        stays = {f"{name}.nc", "import.csv", IMPORT_REPORT, "checks.csv"}
    for entry in folder.iterdir():
        if entry.name in stays:
            continue
        if entry.is_dir() and not entry.is_symlink():
            shutil.rmtree(entry)
        else:
            entry.unlink()
    if stays:
        return f"{folder.name}: results removed, the imported campaign {name}.nc stays"
    folder.rmdir()
    return f"{folder.name}: removed"


if __name__ == "__main__":
    try:
        print(remove_study(sys.argv[1]))
    except ValueError as error:
        sys.exit(str(error))
