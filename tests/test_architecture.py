"""The house and its rooms: imports go downwards, each door is in one place, files hold one idea."""

import ast
import re
from pathlib import Path

import pytest

import vibroimpact

ROOT = Path(__file__).parents[1]
LIBRARY = ROOT / "src" / "vibroimpact"
FILES = sorted(LIBRARY.rglob("*.py"))
KERNELS = LIBRARY / "integration" / "kernels"
EVIDENCE = ROOT / "evidence"
SCRIPTS = [
    file
    for folder in (ROOT / "workflow", EVIDENCE)
    for file in sorted((folder / "scripts").glob("*.py"))
]
RULES = [
    file
    for folder in (ROOT / "workflow", EVIDENCE)
    for file in sorted((folder / "rules").glob("*.smk"))
]
STAGES = [ROOT / "workflow" / "scripts" / file.name for file in (LIBRARY / "stages").glob("[a-z]*")]
EXAMPLES = sorted((ROOT / "examples").glob("*/*.py"))

# From the lowest package up: a package, or a module beside them, imports only from those above it
# in this list. docs/architecture.md says what each is for.
PACKAGES = (
    "__init__",
    "io",
    "geometry",
    "config",
    "structure",
    "excitation",
    "reduction",
    "integration",
    "identify",
    "flow",
    "campaign",
    "study",
    "effects",
    "diagnosis",
    "equivalent_support",
    "reports",
    "stages",
    "stability_command",
    "cli",
    "__main__",
)
ANATOMY = [
    "input",
    "output",
    "log",
    "benchmark",
    "threads",
    "resources",
    "params",
    "message",
    "script",
]
ALLOWED_BETWEEN = {
    "name",
    "priority",
}  # optional: the name of one of many rules made in a loop; priority, after threads
NO_INPUT = [key for key in ANATOMY if key != "input"]  # of a rule that reads no file


def module_of(file):
    """The dotted name of a library file below the package: identify.lscf, cases, __init__."""
    parts = file.relative_to(LIBRARY).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" and len(parts) > 1 else parts)


MODULES = {module_of(file): file for file in FILES}


def tree_of(file):
    """The parsed source of a file."""
    return ast.parse(file.read_text(encoding="utf-8"), filename=str(file))


def imports(file):
    """The absolute dotted names that a file imports, at any depth: with `from a import b`, both a
    and a.b.
    """
    names = set()
    package = (
        ("vibroimpact", *file.relative_to(LIBRARY).parts[:-1]) if LIBRARY in file.parents else ()
    )
    for node in ast.walk(tree_of(file)):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else ()
            base = ".".join([*above, *filter(None, [node.module])])
            names.update([base, *(f"{base}.{alias.name}" for alias in node.names)])
    return names


def library_imports(file):
    """The modules of the library that a file imports."""
    own = {name for name in imports(file) if name.split(".")[0] == "vibroimpact"}
    return {name.removeprefix("vibroimpact.") for name in own} & set(MODULES) - {module_of(file)}


def package_of(module):
    """The first part of a module's dotted name."""
    return module.split(".")[0]


def imported_tops(file):
    """The top-level packages that a file imports."""
    return {name.split(".")[0] for name in imports(file)}


def test_every_package_has_its_place():
    assert sorted({package_of(module) for module in MODULES}) == sorted(PACKAGES)


@pytest.mark.parametrize("package", PACKAGES)
def test_imports_go_one_way(package):
    above = PACKAGES[: PACKAGES.index(package) + 1]
    upwards = {
        f"{module} imports {name}"
        for module, file in MODULES.items()
        if package_of(module) == package
        for name in library_imports(file)
        if package_of(name) not in above
    }
    assert upwards == set()


def test_no_module_imports_itself_through_others():
    graph = {module: library_imports(file) for module, file in MODULES.items()}
    done, open_ = set(), []

    def visit(module):
        assert module not in open_, " -> ".join([*open_, module])
        if module in done:
            return
        open_.append(module)
        for name in graph[module]:
            visit(name)
        done.add(open_.pop())

    for module in graph:
        visit(module)


def test_netcdf_has_one_door():
    doors = {
        "open_dataset",
        "load_dataset",
        "open_mfdataset",
        "open_dataarray",
        "load_dataarray",
        "to_netcdf",
        "to_zarr",
        "open_zarr",
    }
    for file in [*FILES, *SCRIPTS]:
        used = {
            node.attr for node in ast.walk(tree_of(file)) if isinstance(node, ast.Attribute)
        } & doors
        if file.name not in ("records.py", "hdf5.py"):  # the second looks for damage alone
            assert used == set() and not imported_tops(file) & {"netCDF4", "h5netcdf", "h5py"}, file


def test_matplotlib_stays_in_the_figures():
    assert [
        file
        for file in [*FILES, *SCRIPTS]
        if "matplotlib" in imported_tops(file) and not module_of_figures(file)
    ] == []


def module_of_figures(file):
    """Whether a file belongs to the figures."""
    return LIBRARY / "reports" / "figures" in file.parents


def test_plotly_stays_in_the_interactive_figures():
    found = [file for file in [*FILES, *SCRIPTS] if "plotly" in imported_tops(file)]
    assert found and {file.parent for file in found} == {
        LIBRARY / "reports" / "figures" / "interactive"
    }


def test_compiled_code_stays_in_the_kernels():
    # The cache of compiled code sees edits in the files of this folder only.
    assert [
        file
        for file in [*FILES, *SCRIPTS]
        if imported_tops(file) & {"numba", "llvmlite"} and file.parent != KERNELS
    ] == []
    assert {
        name
        for file in KERNELS.glob("*.py")
        for name in library_imports(file)
        if name != "integration.kernels" and not name.startswith("integration.kernels.")
    } == set()


def test_the_library_knows_nothing_of_workflow_and_evidence():
    assert [file for file in FILES if imported_tops(file) & {"snakemake", "evidence"}] == []


def test_no_sentence_of_the_library_needs_a_makefile():
    for file in FILES:  # the installed package has none
        text = file.read_text()
        assert not re.search(r"\bmake (study|smoke|judges|test|docs|clean)|[Mm]akefile", text), file


def test_modules_are_imported_by_name():
    # provenance.imported_files reads import statements: a name made at run time would hide a file
    # from its rule.
    for file in [*FILES, *SCRIPTS]:
        by_name = file in (
            LIBRARY / "io" / "provenance.py",
            LIBRARY / "__init__.py",
            LIBRARY / "integration" / "entry_points.py",  # files that it imports by name as well
        )
        assert by_name or "importlib" not in imported_tops(file), file
        calls = {
            node.func.id
            for node in ast.walk(tree_of(file))
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
        }
        assert not calls & {"__import__", "exec", "eval"}, file


def test_the_public_interface_is_for_users_only():
    # What vibroimpact/__init__.py offers is imported by name: the workflow would not see the files.
    public = {f"vibroimpact.{name}" for name in vibroimpact.PUBLIC}
    assert [file for file in [*FILES, *SCRIPTS] if imports(file) & public] == []


def test_no_module_is_called_utils_or_helpers():
    assert [file for file in FILES if re.search("util|helper|common|misc", file.stem)] == []


def test_every_file_and_public_function_has_a_docstring():
    silent = []
    for file in FILES:
        tree = tree_of(file)
        public = [
            node
            for node in tree.body
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.name.startswith("_")
        ]
        silent += [
            f"{file.name}:{getattr(node, 'name', '')}"
            for node in (tree, *public)
            if not ast.get_docstring(node)
        ]
    assert silent == []


def test_errors_are_not_swallowed_and_warnings_not_silenced():
    for file in [*FILES, *SCRIPTS]:
        for node in ast.walk(tree_of(file)):
            assert not (isinstance(node, ast.ExceptHandler) and node.type is None), (
                f"{file}:{node.lineno} bare except"
            )
            name = ast.unparse(node.func) if isinstance(node, ast.Call) else ""
            assert name not in (
                "warnings.filterwarnings",
                "warnings.simplefilter",
                "np.seterr",
                "numpy.seterr",
            ), f"{file}:{node.lineno}"


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda file: file.stem)
def test_scripts_define_nothing(script):
    defined = (ast.FunctionDef, ast.ClassDef, ast.Lambda)
    assert [node for node in ast.walk(tree_of(script)) if isinstance(node, defined)] == []


@pytest.mark.parametrize("script", STAGES, ids=lambda file: file.stem)
def test_a_script_calls_one_function_of_the_library(script):
    first, second, call = tree_of(script).body[1:]
    assert isinstance(first, ast.ImportFrom) and isinstance(second, ast.ImportFrom)
    assert ast.unparse(call).startswith(f"run_job({script.stem}.make, snakemake")


def rules():
    """(name, keys in their order) of every rule in workflow/rules, those inside a loop among
    them.
    """
    for file in RULES:
        for indent, name, body in re.findall(
            r"^( *)(?:rule|checkpoint) (\w+):\n((?:(?:\1    .*)?\n)+)", file.read_text(), flags=re.M
        ):
            yield name, re.findall(rf"^{indent}    (\w+):", body, flags=re.M)


def test_there_is_a_script_for_every_rule():
    names = sorted(name.removeprefix("_") for name, _ in rules())
    assert names == sorted(file.stem for file in SCRIPTS)


def test_public_rules_and_no_others_describe_themselves():
    described = {}
    for file in [*RULES, ROOT / "Snakefile"]:
        found = re.findall(r'^ *(?:rule|checkpoint) (\w+):\n( *""")?', file.read_text(), flags=re.M)
        described |= {name: bool(docstring) for name, docstring in found}
    assert {"all", "discrepancy", "_simulate"} <= set(described)
    assert {n for n, has in described.items() if has == n.startswith("_")} == set()


def test_rules_have_the_same_anatomy():
    assert {
        name: keys
        for name, keys in rules()
        if [key for key in keys if key not in ALLOWED_BETWEEN] not in (ANATOMY, NO_INPUT)
    } == {}


def test_rules_hold_no_physics():
    # Numbers in rules are resources and counts; a value with a point or an exponent is physics that
    # belongs into the configuration.
    for file in RULES:
        code = re.sub(r"#.*|\"\"\".*?\"\"\"|r?f?\"[^\"]*\"", "", file.read_text())
        assert re.findall(r"\b\d+\.\d*\b|\b\d+e-?\d+\b", code) == [], file
        assert not re.search(r"^ +(run|shell):", file.read_text(), flags=re.M), file


def test_the_library_and_its_rules_know_no_example():
    names = "|".join(sorted({file.parent.name for file in EXAMPLES}))
    files = [*LIBRARY.rglob("*.*"), *(ROOT / "workflow").rglob("*.*")]
    named = [
        file
        for file in files
        if file.suffix in (".py", ".smk", ".html", ".css")
        and re.search(rf"{names}|f-16", file.name + file.read_text(encoding="utf-8"), flags=re.I)
    ]
    assert names == "f16|silverbox" and named == []


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda file: f"{file.parent.name}/{file.stem}")
def test_examples_use_the_public_interface_only(example):
    private = [
        name
        for name in imports(example)
        if name.startswith("vibroimpact") and any(part.startswith("_") for part in name.split("."))
    ]
    assert private == []


def test_test_names_are_short():
    names = {
        node.name: file.name
        for file in (ROOT / "tests").rglob("test_*.py")
        for node in ast.walk(tree_of(file))
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
    }
    assert {name: file for name, file in names.items() if len(name) > 60} == {}


def test_no_line_is_longer_than_100_columns():
    folders = ("src", "tests", "workflow", "examples", "evidence", "config", "docs")
    endings = {".py", ".pyi", ".smk", ".yaml", ".toml", ".html", ".css", ".js", ".rst", ".in"}
    files = [file for folder in folders for file in (ROOT / folder).rglob("*")]
    files = [file for file in [*files, *ROOT.glob("*")] if file.suffix in endings]
    files += [ROOT / "Makefile", ROOT / "Snakefile", ROOT / ".ci" / "run"]
    built = {"_build", "generated"}
    long = [
        f"{file.relative_to(ROOT)}:{number}"
        for file in files
        if not built & set(file.parts)
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), start=1)
        if len(line) > 100
    ]
    assert long == []
