"""The origin of a result: digests of configuration and source, versions, imported files."""

import hashlib
import json
import platform
import re
from collections.abc import Iterable, Mapping
from functools import cache, lru_cache
from importlib import metadata
from pathlib import Path
from typing import Any

import yaml

from vibroimpact import __version__

PACKAGES = ("vibroimpact", "evidence")  # whose files stand for the code of a result
VERSIONED = ("numpy", "scipy", "numba", "xarray", "netCDF4", "matplotlib", "snakemake")
DIGEST_LENGTH = 16
# An import statement at any depth: `import a, b`, or the dots, module and names of `from`. To parse
# each file takes ten times as long. A line of prose that looks like one lists a file too many.
IMPORT = re.compile(
    r"^[ \t]*(?:import[ \t]+([^\n;]+)"
    r"|from[ \t]+(\.*)([\w.]*)[ \t]+import[ \t]*(\([^)]*\)|[^\n;]+))",
    flags=re.M,
)


def config_digest(params: Mapping[str, Any]) -> str:
    """Return 16 hexadecimal digits that stand for the keys and values of one stage."""
    return hashlib.sha256(_text_of(params).encode()).hexdigest()[:DIGEST_LENGTH]


def _text_of(params: Mapping[str, Any]) -> str:
    """Return keys and values as JSON, in one order whatever the order given."""
    return json.dumps(params, sort_keys=True, default=dict)


def source_digest(files: Iterable[Path | str]) -> str:
    """Return 16 hexadecimal digits that stand for the names and contents of library files."""
    digest = hashlib.sha256()
    for name, file in sorted((_name_in_package(file), file) for file in map(Path, files)):
        digest.update(name.encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()[:DIGEST_LENGTH]


def _name_in_package(file: Path) -> str:
    """Return the path of a file below its package's folder, wherever the checkout lies."""
    parts = file.parts
    last = max((at for at, part in enumerate(parts) if part in PACKAGES), default=len(parts) - 2)
    return "/".join(parts[last + 1 :])


@lru_cache(maxsize=1)
def versions() -> dict[str, str]:
    """Return {name: version} of Python and of the packages that results depend on."""
    found = {"python": platform.python_version()}
    for name in VERSIONED:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = "not installed"
    return found


def origin(params: Mapping[str, Any], library: str) -> dict[str, str]:
    """Return {name: text} of the origin of a result.

    They are the version of vibroimpact, the digests of a stage's keys and of its source files, and
    the versions of the packages that it used.

    library: the library_digest of the stage.
    """
    return {
        "vibroimpact_version": __version__,
        "config_digest": config_digest(params),
        "source_digest": library,
        "versions": " ".join(f"{name} {version}" for name, version in versions().items()),
    }


def verdict_origin(params: Mapping[str, Any], campaign: Path | str) -> dict[str, Any]:
    """Return {name: value} of the origin of a verdict: version, digests of the whole package, of
    the campaign file and of the configuration, seed (None: nothing is drawn), versions of packages.

    params: the configuration in plain values.
    campaign: the campaign file.
    """
    with open(campaign, "rb") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()[:DIGEST_LENGTH]
    return {
        "version": __version__,
        "source_digest": package_digest(),
        "campaign_digest": digest,
        "configuration_digest": config_digest(params),
        "seed": None,
        "versions": " ".join(f"{name} {version}" for name, version in versions().items()),
    }


def file_attributes(params: Mapping[str, Any], library: str) -> dict[str, str]:
    """Return the global attributes of a netCDF file of a stage: its origin and its configuration.

    params: {dotted key: value} that the stage was given. As YAML they are the attribute
    `configuration`; with `config_digest` they are the settings that the file depends on: a key of a
    later stage changes neither.
    library: the library_digest of the stage.
    """
    study = {"study": str(params["study"])} if "study" in params else {}
    text = yaml.safe_dump(json.loads(_text_of(params)), sort_keys=True, allow_unicode=True)
    return {**study, **origin(params, library), "configuration": text}


def package_digest() -> str:
    """Return 16 hexadecimal digits that stand for all source files of the package."""
    return source_digest(Path(__file__).parents[1].rglob("*.py"))


def library_digest(script: Path | str, *sources: Path | str) -> str:
    """Return 16 hexadecimal digits that stand for the library files that a script imports.

    They change with the content of these files and of no others. Arguments and errors are those of
    imported_files.
    """
    return source_digest(imported_files(script, *sources))


def imported_files(script: Path | str, *sources: Path | str) -> list[Path]:
    """Return the library files that a script imports, directly or through others, sorted.

    script: a Python file.
    sources: the folders that hold the packages (src, and the top of a checkout).

    Imports inside functions count, and so does the __init__.py of every package on the way. Nothing
    is executed: imports of names computed at run time are not seen.

    Raises FileNotFoundError when the script does not exist.
    """
    folders = tuple(map(Path, sources))
    found: set[Path] = set()
    waiting = [Path(script)]
    while waiting:
        file = waiting.pop()
        for module in _imports(file, folders, file.stat().st_mtime_ns):
            if module not in found:
                found.add(module)
                waiting.append(module)
    return sorted(found)


@cache
def _imports(file: Path, sources: tuple[Path, ...], _changed_at: int) -> frozenset[Path]:
    """Return the library files that a file imports itself.

    Cached by the time of the last change: the scripts share most of their imports.
    """
    return frozenset(
        module
        for name in _imported_names(file, sources)
        for source in sources
        for module in _files_of(name, source)
    )


def _imported_names(file: Path, sources: tuple[Path, ...]) -> set[str]:
    """Return the dotted names inside the packages that a file imports."""
    names: set[str] = set()
    for plain, level, module, listed in IMPORT.findall(file.read_text(encoding="utf-8")):
        if plain:
            names.update(_names_in(plain))
            continue
        base = ".".join(filter(None, [_package_above(file, sources, len(level)), module]))
        names.add(base)
        names.update(f"{base}.{name}" for name in _names_in(listed))
    return {name for name in names if name.split(".")[0] in PACKAGES}


def _names_in(text: str) -> list[str]:
    """Return the names in the list of an import statement, without their `as` and comments."""
    parts = re.sub(r"#.*|[()\\]", "", text).split(",")
    return [words[0] for words in map(str.split, parts) if words]


def _package_above(file: Path, sources: tuple[Path, ...], level: int) -> str:
    """Return the dotted package that `level` leading dots mean in a file; '' for none."""
    if level == 0:
        return ""
    source = next(one for one in sources if file.is_relative_to(one))
    parts = file.relative_to(source).parts[:-1]
    return ".".join(parts[: len(parts) - level + 1])


@cache
def _files_of(name: str, source: Path) -> tuple[Path, ...]:
    """Return the files that importing a dotted name executes: every __init__.py and the module."""
    files: list[Path] = []
    folder = source
    for part in name.split("."):
        if (folder / f"{part}.py").is_file():
            return (*files, folder / f"{part}.py")
        folder = folder / part
        if (folder / "__init__.py").is_file():
            files.append(folder / "__init__.py")
    return tuple(files)
