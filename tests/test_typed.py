"""Type hints on the public interface: every public function names its types, package by package."""

import ast
from pathlib import Path

import pytest

LIBRARY = Path(__file__).parents[1] / "src" / "vibroimpact"

# Folders without complete type hints so far. One leaves this list when its test passes.
NOT_YET_TYPED = ("reports/figures",)
PACKAGES = sorted(
    {path.relative_to(LIBRARY).parts[0].split(".")[0] for path in LIBRARY.rglob("*.py")}
)


# Compiled functions take arrays of lanes, whose types numba infers: hints would say nothing.
COMPILED = LIBRARY / "integration" / "kernels"


def files_of(package: str) -> list[Path]:
    """The source files of a package, or of a single module beside the packages."""
    files = sorted((LIBRARY / package).rglob("*.py")) or [LIBRARY / f"{package}.py"]
    left_out = {COMPILED, *(LIBRARY / folder for folder in NOT_YET_TYPED)}
    return [file for file in files if left_out.isdisjoint(file.parents)]


def without_hints(source: str) -> list[str]:
    """The public functions of a module, and methods of public classes, that lack a type hint."""
    tree = ast.parse(source)
    public = [node for node in tree.body if not getattr(node, "name", "_").startswith("_")]
    functions = [node for node in public if isinstance(node, ast.FunctionDef)]
    for node in public:
        if isinstance(node, ast.ClassDef):
            functions += [
                item
                for item in node.body
                if isinstance(item, ast.FunctionDef)
                and (item.name == "__init__" or not item.name.startswith("_"))
            ]
    return [function.name for function in functions if not is_annotated(function)]


def is_annotated(function: ast.FunctionDef) -> bool:
    """Whether all arguments but self and cls, and the return of all but __init__, are annotated."""
    given = function.args
    arguments = [*given.posonlyargs, *given.args, *given.kwonlyargs, given.vararg, given.kwarg]
    returns = function.returns is not None or function.name == "__init__"
    return returns and all(
        argument.annotation is not None
        for argument in arguments
        if argument is not None and argument.arg not in ("self", "cls")
    )


@pytest.mark.parametrize("package", PACKAGES)
def test_public_functions_have_type_hints(package):
    missing = {
        str(path.relative_to(LIBRARY)): names
        for path in files_of(package)
        if (names := without_hints(path.read_text(encoding="utf-8")))
    }
    assert missing == {}


@pytest.mark.parametrize(
    "source, missing",
    [
        ("def area(radius: float) -> float: ...", []),
        ("def area(radius) -> float: ...", ["area"]),
        ("def area(radius: float): ...", ["area"]),
        ("def area(*radii) -> float: ...", ["area"]),
        ("def _area(radius): ...", []),
        ("class Disc:\n    def area(self): ...", ["area"]),
        ("class Disc:\n    def __init__(self, radius): ...", ["__init__"]),
    ],
)
def test_a_missing_type_hint_is_found(source, missing):
    assert without_hints(source) == missing


if __name__ == "__main__":
    print(f"Packages without complete type hints: {', '.join(NOT_YET_TYPED)}")
