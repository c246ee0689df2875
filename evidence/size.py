"""How large the project is, beside its limits: `python -m evidence.size`, a part of `make lint`."""

import ast
import io
import tokenize
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
LIBRARY = ROOT / "src" / "vibroimpact"
MANUALS = ("docs/**/*.md", "*.md")
NO_CODE = (tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT)
LONG_FUNCTION = 60  # lines


def lines(files):
    """Return the number of lines of files."""
    return sum(len(file.read_text(encoding="utf-8").splitlines()) for file in files)


def lines_of_code(file):
    """Return the number of lines that hold code: no blank line, comment or docstring."""
    text = file.read_text(encoding="utf-8")
    held = {
        number
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
        if token.type not in NO_CODE and token.string
        for number in range(token.start[0], token.end[0] + 1)
    }
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, documented) and ast.get_docstring(node, clean=False) is not None:
            held -= set(range(node.body[0].lineno, node.body[0].end_lineno + 1))
    return len(held)


def words(patterns):
    """Return the number of words of the files that patterns below the root match."""
    files = {file for pattern in patterns for file in ROOT.glob(pattern)}
    built = {"_build", "generated"}
    return sum(
        len(file.read_text(encoding="utf-8").split())
        for file in files
        if not built & set(file.parts)
    )


def functions(files):
    """Return [(lines, file:name)] of the functions of files, the longest first."""
    found = [
        (node.end_lineno - node.lineno + 1, f"{file.relative_to(ROOT)}:{node.name}")
        for file in files
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
    ]
    return sorted(found, reverse=True)


def longest_chain(files):
    """Return the number of modules of the longest chain of imports in the library."""
    modules = {
        ".".join(file.relative_to(ROOT / "src").with_suffix("").parts): file for file in files
    }

    def imported(module):
        package = module.split(".")[:-1]
        for node in ast.walk(ast.parse(modules[module].read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom):
                above = package[: len(package) - node.level + 1] if node.level else []
                base = ".".join([*above, *filter(None, [node.module])])
                yield from (base, *(f"{base}.{alias.name}" for alias in node.names))

    @cache
    def depth(module):
        below = {name for name in imported(module) if name in modules and name != module}
        return 1 + max(map(depth, below), default=0)

    return max(map(depth, modules))


def rows():
    """Return [(quantity, value, limit)], None where there is no limit."""
    library = sorted(LIBRARY.rglob("*.py"))
    lengths = functions(library)
    library_lines = lines(library)
    tests = lines((ROOT / "tests").rglob("*.py"))
    singles = [file for file in LIBRARY.glob("*.py") if not file.stem.startswith("__")]
    packages = list(LIBRARY.glob("*/__init__.py"))
    return [
        ("lines of the library", library_lines, 40_000),
        ("lines of code in it", sum(map(lines_of_code, library)), 27_000),
        ("lines of the diagnosis", lines((LIBRARY / "diagnosis").rglob("*.py")), 6_000),
        ("lines of the evidence", lines((ROOT / "evidence").rglob("*.py")), None),
        ("lines of tests per line", round(tests / library_lines, 2), 0.6),
        ("words of documentation", words(MANUALS), 30_000),
        ("words of the README", words(["README.md"]), 700),
        ("single modules at the top", len(singles), 10),
        ("packages at the top", len(packages), 16),
        ("longest chain of imports", longest_chain(library), 14),
        (f"functions over {LONG_FUNCTION} lines", sum(n > LONG_FUNCTION for n, _ in lengths), 0),
        ("rule files", len(list((ROOT / "workflow" / "rules").glob("*.smk"))), 14),
        ("scripts of rules", len(list((ROOT / "workflow" / "scripts").glob("*.py"))), 20),
    ]


if __name__ == "__main__":
    for quantity, value, limit in rows():
        over = "" if limit is None else f"limit {limit:>8,}{'  over' if value > limit else ''}"
        print(f"{quantity:28} {value:>8,}   {over}".rstrip())
