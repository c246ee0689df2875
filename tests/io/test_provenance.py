"""Provenance: the files that a script imports, and digests that change with what they stand for and
with nothing else.
"""

import ast
import json
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

import vibroimpact
from vibroimpact.io import provenance
from vibroimpact.io.provenance import (
    config_digest,
    file_attributes,
    imported_files,
    library_digest,
    origin,
    package_digest,
    source_digest,
    versions,
)

ROOT = Path(__file__).parents[2]
SCRIPTS = sorted((ROOT / "workflow" / "scripts").glob("*.py"))


# Imports inside every kind of block.
LAZY = """
class Shape:
    def lazy(self, kind):
        match kind:
            case 1:
                try:
                    pass
                except ValueError:
                    pass
                else:
                    with open(kind):
                        while kind:
                            from .inner import deep
                finally:
                    from . import plain
"""


@pytest.fixture
def library(tmp_path):
    """A small package with every form of import, and a script beside it."""
    files = {
        "src/vibroimpact/__init__.py": "",
        "src/vibroimpact/alone.py": "import numpy",
        "src/vibroimpact/top.py": "from vibroimpact.middle import name\nimport os.path",
        "src/vibroimpact/middle.py": LAZY,
        "src/vibroimpact/inner/__init__.py": "from . import sibling",
        "src/vibroimpact/inner/sibling.py": "",
        "src/vibroimpact/inner/deep.py": "from ..plain import value",
        "src/vibroimpact/plain.py": "import vibroimpact.circle",
        "src/vibroimpact/circle.py": "from vibroimpact import top, __version__",
    }
    for name, text in files.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path


def imported(library, text):
    """The names of the library files behind a script with the given text."""
    script = library / "script.py"
    script.write_text(text)
    return {
        str(file.relative_to(library / "src" / "vibroimpact"))
        for file in imported_files(script, library / "src")
    }


def test_imports_are_followed_through_every_form(library):
    everything = {
        "__init__.py",
        "top.py",
        "middle.py",
        "inner/__init__.py",
        "inner/sibling.py",
        "inner/deep.py",
        "plain.py",
        "circle.py",
    }
    assert imported(library, "from vibroimpact.top import name") == everything
    assert imported(library, "from vibroimpact import top") == everything
    assert imported(library, "import vibroimpact.top as t") == everything


def test_only_imported_files_are_listed(library):
    assert imported(library, "import vibroimpact.alone") == {"__init__.py", "alone.py"}
    assert imported(library, "from vibroimpact.inner.sibling import x") == {
        "__init__.py",
        "inner/__init__.py",
        "inner/sibling.py",
    }
    assert imported(library, "import numpy, vibroimpacts.top") == set()


# Prints, one line per script of the list: its name and the library files that its imports load. One
# interpreter loads what all scripts share from elsewhere and forks for each.
LISTING = """
import json, os, sys
import h5py, jinja2, matplotlib.pyplot, netCDF4, numba.extending, pandas, pint, pydantic, pyuff
import scipy.interpolate, scipy.optimize, scipy.signal, scipy.sparse.linalg, scipy.stats, xarray
for name, imports in json.load(sys.stdin).items():
    if os.fork() == 0:
        exec(imports)
        loaded = [m.__file__ for n, m in sys.modules.items() if n.split('.')[0] == 'vibroimpact']
        print(json.dumps([name, loaded]), flush=True)
        os._exit(0)
    assert os.wait()[1] == 0, name
"""


@pytest.mark.slow
def test_imported_files_cover_what_python_loads():
    """The interpreter runs the imports of every script; it may load no file that the static reading
    of the imports does not list.
    """
    imports = {
        script.stem: "\n".join(
            ast.unparse(node)
            for node in ast.parse(script.read_text()).body
            if isinstance(node, (ast.Import, ast.ImportFrom))
        )
        for script in SCRIPTS
    }
    run = subprocess.run(
        [sys.executable, "-c", LISTING],
        input=json.dumps(imports),
        capture_output=True,
        text=True,
        check=True,
        env={"PYTHONPATH": str(ROOT / "src"), "PATH": "", "MPLBACKEND": "agg"},
    )
    loaded = dict(json.loads(line) for line in run.stdout.splitlines())
    assert set(loaded) == set(imports)
    missed = {
        script.stem: {Path(file) for file in loaded[script.stem]}
        - set(imported_files(script, ROOT / "src"))
        for script in SCRIPTS
    }
    assert {name: files for name, files in missed.items() if files} == {}


def test_config_digest_depends_on_keys_and_values():
    digest = config_digest({"a": 1.0, "b": {"c": [1, 2]}})
    assert digest == config_digest({"b": {"c": [1, 2]}, "a": 1.0})
    others = [
        {"a": 1.1, "b": {"c": [1, 2]}},
        {"a": 1.0, "b": {"c": [2, 1]}},
        {"a": 1.0},
        {"x": 1.0, "b": {"c": [1, 2]}},
    ]
    assert digest not in {config_digest(other) for other in others}


def test_source_digest_depends_on_contents_not_location(tmp_path):
    for folder in ("here", "there"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "a.py").write_text("1")
        (tmp_path / folder / "b.py").write_text("2")
    here, there = (
        [tmp_path / folder / "a.py", tmp_path / folder / "b.py"] for folder in ("here", "there")
    )
    assert source_digest(here) == source_digest(reversed(there))
    there[0].write_text("3")
    assert source_digest(here) != source_digest(there)


def test_an_origin_names_digests_and_versions():
    found = origin({"seed": 1}, "0a1b2c3d4e5f6789")
    assert found["source_digest"] == "0a1b2c3d4e5f6789"
    assert set(found) == {"vibroimpact_version", "config_digest", "source_digest", "versions"}
    assert found["vibroimpact_version"] == vibroimpact.__version__
    assert f"python {sys.version.split()[0]}" in found["versions"]
    assert "not installed" not in versions().values()


def test_a_file_carries_the_configuration_of_its_stage():
    keys = {"study": "mine", "grid.gap_m": [2.5e-5, 1e-4], "seed": 7}
    found = file_attributes(keys, "")
    assert yaml.safe_load(found["configuration"]) == keys
    assert found["study"] == "mine"
    again = file_attributes(dict(reversed(keys.items())), "")
    assert again == found and found["config_digest"] == config_digest(keys)
    assert "study" not in file_attributes({"seed": 1}, "")


def test_library_digest_changes_with_imported_files_alone(library):
    script = library / "script.py"
    script.write_text("from vibroimpact.inner.sibling import x")
    source = library / "src"
    before = library_digest(script, source)
    assert before == source_digest(imported_files(script, source))
    sibling, alone = (source / "vibroimpact" / name for name in ("inner/sibling.py", "alone.py"))
    alone.write_text("import scipy")
    sibling.touch()
    assert library_digest(script, source) == before
    sibling.write_text("x = 1")
    assert library_digest(script, source) != before


def test_package_digest_is_that_of_all_its_files(monkeypatch, tmp_path):
    package = tmp_path / "vibroimpact"
    (package / "inner").mkdir(parents=True)
    for name in ("provenance.py", "inner/deep.py"):
        (package / name).write_text("1")
    monkeypatch.setattr(provenance, "__file__", str(package / "provenance.py"))
    before = package_digest()
    assert before == source_digest([package / "provenance.py", package / "inner" / "deep.py"])
    (package / "inner" / "deep.py").write_text("2")
    assert package_digest() != before
