"""The pages of the site that are made from the code: configuration keys, effects, command line,
Python interface and notebooks.
"""

import importlib
import inspect
import json
import pkgutil
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

from docutils import nodes

import vibroimpact

# The packages that a user's own program imports; the others serve the workflow.
PUBLIC = (
    "io",
    "geometry",
    "config",
    "structure",
    "excitation",
    "reduction",
    "integration",
    "identify",
    "study",
    "campaign",
    "effects",
)
MEANING_IS_WIDE = "<style>article td:nth-child(2) { min-width: 16em; }</style>\n\n"
# An argument's line in a docstring, "name: meaning" or "name, name (shape): meaning".
ARGUMENT = re.compile(r"^\s*(?!Source|Raises|Returns?\b)[a-z_]\w*(?:, \w+)*(?: \([^)]*\))?: +\S")


def setup(app):
    """Connect this module, an extension of Sphinx, to the build of the site."""
    app.connect("config-inited", write_generated_pages)
    app.connect("autodoc-process-docstring", docstring_as_rst)
    app.connect("autodoc-process-signature", short_signature)
    app.connect("doctree-read", captions_from_alternative_text)
    return {"parallel_read_safe": True}


def write_generated_pages(app, config):
    """Write every generated page into docs/generated."""
    folder = Path(app.srcdir, "generated")
    folder.mkdir(exist_ok=True)
    keys = _made_by("vibroimpact.config.key_reference")
    _write(folder / "configuration_keys.md", MEANING_IS_WIDE + _meaning_second(keys))
    _write(folder / "effects.md", _made_by("effects_page"))
    _write(folder / "command_line.md", _command_line())
    _write(folder / "command_line_equivalent.md", _command_line("equivalent"))
    _write(folder / "command_line_supports.md", _command_line("supports"))
    python = folder / "python"
    packages = python / "packages"
    packages.mkdir(parents=True, exist_ok=True)
    _write(python / "vibroimpact.rst", _public_page())
    pages = {f"{package}.rst": _package_page(package) for package in PUBLIC}
    for stale in {path.name for path in packages.glob("*.rst")} - set(pages):
        (packages / stale).unlink()
    for name, text in pages.items():
        _write(packages / name, text)
    (folder / "notebooks").mkdir(exist_ok=True)
    for path in sorted(Path(app.srcdir, "notebooks").glob("*.ipynb")):
        _write(folder / "notebooks" / f"{path.stem}.md", _notebook_page(path))


def docstring_as_rst(app, what, name, obj, options, lines):
    """Turn a docstring in plain text into reStructuredText, in place: arguments become a list,
    characters with a meaning in reStructuredText are shown as they are.
    """
    result, inside = [""], False
    for line in map(str.strip, lines):
        item = line.startswith("- ") or (ARGUMENT.match(line) and (inside or not result[-1]))
        if inside and not item and line.startswith(("Raises", "Source", "Returns")):
            inside = False
            result.append("")
        if not line:
            inside = False
            result.append("")
        elif item:
            result += [""] if result[-1] and not inside else []
            inside = True
            result.append(f"* {_escaped(line.removeprefix('- '))}")
        else:
            result.append(("  " if inside else "") + _escaped(line))
    lines[:] = [*result[1:], ""]


def short_signature(app, what, name, obj, options, signature, returned):
    """Return the signature of a section of the configuration without its keys, which have a page of
    their own; None leaves other signatures as they are.
    """
    return ("(keys)", "") if hasattr(obj, "model_fields") else None


def captions_from_alternative_text(app, doctree):
    """Give every picture that stands alone a caption, its alternative text, unless a paragraph in
    italics follows, which is its caption already.
    """
    for number, image in enumerate(list(doctree.findall(nodes.image)), 1):
        alone = image.parent
        if not isinstance(alone, nodes.paragraph) or len(alone) > 1 or not image.get("alt"):
            continue
        follows = alone.next_node(descend=False, siblings=True)
        if isinstance(follows, nodes.paragraph) and isinstance(follows[0], nodes.emphasis):
            continue
        caption = nodes.caption("", "", nodes.Text(image["alt"]))
        figure = nodes.figure("", image.deepcopy(), caption, ids=[f"figure-{number}"])
        alone.replace_self(figure)


def _escaped(text):
    """Return text with `code` as literals and every other special character escaped."""
    parts = re.split(r"`+([^`]+)`+", text)
    shown = [re.sub(r"([\\*|_`<>])", r"\\\1", part) for part in parts]
    shown[1::2] = [f"\\ ``{part}``\\ " for part in parts[1::2]]
    return "".join(shown)


def _write(path, text):
    """Write text where it differs from what is there, so that unchanged pages are not built
    again.
    """
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def _made_by(module):
    """Return module.markdown() to be included in a page, or a sentence where this version has no
    such module.
    """
    if find_spec(module) is None:
        return f"*This version has no `{module}`.*\n"
    text = importlib.import_module(module).markdown()
    return _links_as_html(re.sub(r"\A# .*\n+", "", text))


def _meaning_second(text):
    """Return text with the column "Meaning" of its tables beside the first one, where a narrow
    screen shows it.
    """
    lines, place = [], None
    for line in text.splitlines():
        cells = re.split(r"(?<!\\)\|", line)[1:-1] if line.startswith("|") else []
        if not cells:
            place = None
        elif place is None:
            names = [cell.strip() for cell in cells]
            place = names.index("Meaning") if "Meaning" in names else 1
        if cells:
            cells.insert(1, cells.pop(place))
            line = f"|{'|'.join(cells)}|"
        lines.append(line)
    return "\n".join(lines) + "\n"


def _links_as_html(text):
    """Return text with its links to places of its own (`<a id="...">`) in HTML, where Sphinx leaves
    them alone. Raises ValueError where such a place is missing.
    """
    places = set(re.findall(r'<a id="([^"]+)"', text))
    links = re.compile(r"\[([^\]]+)\]\(#([^)]+)\)")
    missing = {target for _, target in links.findall(text)} - places if places else set()
    if missing:
        raise ValueError(f"links to places that are not there: {sorted(missing)}")

    def html(match):
        shown = re.sub(r"`([^`]+)`", r"<code>\1</code>", match[1])
        return f'<a class="reference internal" href="#{match[2]}">{shown}</a>'

    return links.sub(html, text) if places else text


def _command_line(*command):
    """Return the help text of the command line, or of one of its commands, as Markdown."""
    root = Path(vibroimpact.__file__).parents[1]
    if find_spec("vibroimpact.__main__") is None:
        return "*This version has no `python -m vibroimpact`.*\n"
    shown = subprocess.run(
        [sys.executable, "-m", "vibroimpact", *command, "--help"],
        capture_output=True,
        text=True,
        check=True,
        env={"PYTHONPATH": str(root), "COLUMNS": "90"},
    ).stdout
    return f"```text\n{shown}```\n"


def _notebook_page(path):
    """Return the text and the code of a notebook as Markdown, without outputs."""
    parts = []
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        text = "".join(cell["source"])
        parts.append(text if cell["cell_type"] == "markdown" else f"```python\n{text}\n```")
    parts.insert(1, f"{{download}}`The notebook <../../notebooks/{path.name}>`")
    return "\n\n".join(parts) + "\n"


def _public_page():
    """Return the page of the names that can be imported from vibroimpact itself."""
    title = "vibroimpact: the public interface"
    parts = [title, "=" * len(title), "", ".. currentmodule:: vibroimpact", ""]
    for name, module in vibroimpact.PUBLIC.items():
        value = getattr(vibroimpact, name)
        kind = "autofunction"
        if inspect.isclass(value):
            kind = "autoexception" if issubclass(value, Exception) else "autoclass"
        parts += [f".. {kind}:: vibroimpact.{module}.{name}", "   :no-index:", ""]
    return "\n".join(parts)


def _package_page(package):
    """Return the page of a package: its docstring, then every module with its functions."""
    top = importlib.import_module(f"vibroimpact.{package}")
    names = [f"vibroimpact.{package}"]
    if hasattr(top, "__path__"):
        names += sorted(
            found.name
            for found in pkgutil.walk_packages(top.__path__, f"vibroimpact.{package}.")
            if not found.ispkg
        )
    title = f"vibroimpact.{package}"
    parts = [title, "=" * len(title), ""]
    for name in names:
        if name != title:
            parts += [name, "-" * len(name), ""]
        parts += [f".. automodule:: {name}", ""]
    return "\n".join(parts)
