"""The reference of every configuration key as Markdown, generated from the declaration."""

from collections.abc import Iterator
from dataclasses import dataclass

from .declared_keys import DeclaredKey, declared, kind_of, meaning_of
from .measured_structure import MeasuredStructure
from .quantities import Section
from .schema import Config

INTRODUCTION = """\
# Configuration keys

Every key of a study's configuration, generated from its declaration. A configuration is a YAML
file. Quantities are in SI units, and the name of a key ends with its unit. A key that is not listed
here is an error. Keys without a default are required.

Unit 1 means a number without unit. In the place of a key, `[]` stands for each entry of a list.
Write numbers in scientific notation as `4.0e+6`, with point and sign.
"""
COLUMNS = ("Key", "Type", "Unit", "Range", "Default", "Meaning", "Example")


@dataclass(frozen=True)
class DeclaredSection:
    """A section at a place of the configuration.

    place: dotted key, "" for the top level; `[]` follows a key that holds a list of sections.
    kind: the value of `kind` that selects it, None if there is no choice.
    meaning: its description.
    """

    place: str
    kind: str | None
    meaning: str
    keys: tuple[DeclaredKey, ...]


def declared_sections() -> list[DeclaredSection]:
    """Return every section of the configuration, from the top level down, each place once."""
    return list(dict.fromkeys(_sections(Config, "")))


def _sections(section: type[Section], place: str) -> Iterator[DeclaredSection]:
    """Yield a section, then those inside it."""
    keys = tuple(declared(name, field) for name, field in section.model_fields.items())
    yield DeclaredSection(place, kind_of(section), meaning_of(section), keys)
    for key in keys:
        inside = place_of(place, key.name) + ("[]" if key.holds.startswith("list") else "")
        for inner in key.sections:
            yield from _sections(inner, inside)


def place_of(section: str, key: str) -> str:
    """Return the dotted place of a key of a section."""
    return f"{section}.{key}" if section else key


def markdown() -> str:
    """Return the reference: one heading and table per section, one anchor per key.

    The anchor of a key is its dotted place without brackets, such as `record.sensors.points`. In a
    section with a `kind`, the kind precedes the key: `supports.profile.lobes.depth_m`.
    """
    parts = [INTRODUCTION]
    places: dict[str, list[DeclaredSection]] = {}
    for section in declared_sections():
        places.setdefault(section.place, []).append(section)
    for place, sections in places.items():
        parts += _at_place(place, sections)
    # Of a file that states a structure to be identified from its campaign.
    measured = next(_sections(MeasuredStructure, "model.structure"))
    parts += [
        f'<a id="{anchor(measured)}"></a>\n\n## `structure` without `modes`\n',
        "The only section of the file that `--config model=FILE` gives for a campaign.\n",
        f"{_escaped(measured.meaning)}\n",
        _table(measured),
    ]
    return "\n".join(parts)


def anchor(section: DeclaredSection, key: str = "") -> str:
    """Return the anchor of a section, or of one of its keys."""
    parts = (section.place.replace("[]", ""), section.kind, key)
    return ".".join(filter(None, parts)) or "top-level"


def _at_place(place: str, sections: list[DeclaredSection]) -> list[str]:
    """Return the Markdown of the sections at a place: one, or one per kind."""
    title = f"`{place}`" if place else "Top level"
    level = min(2 + place.count("."), 4)
    parts = []
    if len(sections) > 1 or sections[0].kind:
        kinds = ", ".join(f"[`{each.kind}`](#{anchor(each)})" for each in sections)
        parts += [
            f'<a id="{place.replace("[]", "")}"></a>\n\n{"#" * level} {title}\n',
            f"The key `kind` selects one of: {kinds}.\n",
        ]
        title, level = title + ", kind ", min(level + 1, 5)
    for section in sections:
        kind = f"`{section.kind}`" if section.kind else ""
        parts += [
            f'<a id="{anchor(section)}"></a>\n\n{"#" * level} {title}{kind}\n',
            f"{_escaped(section.meaning)}\n",
            _table(section),
        ]
    return parts


def _table(section: DeclaredSection) -> str:
    """Return the table of a section's keys."""
    rows = [COLUMNS, ("---",) * len(COLUMNS), *(_row(section, key) for key in section.keys)]
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def _row(section: DeclaredSection, key: DeclaredKey) -> tuple[str, ...]:
    """Return the cells of a key."""
    own, inside = anchor(section, key.name), place_of(section.place, key.name).replace("[]", "")
    # A key that holds a section shares its place, and so its anchor, with the section's heading.
    target = "" if key.sections and own == inside else f'<a id="{own}"></a>'
    return (
        f"{target}`{key.name}`",
        _linked(key, inside),
        key.unit,
        key.range,
        "required" if key.default is None else f"`{key.default}`",
        _escaped(key.meaning).replace("|", "\\|"),
        f"`{key.example}`" if key.example else "",
    )


def _linked(key: DeclaredKey, inside: str) -> str:
    """Return the type of a key; blocks of keys are links to the anchor `inside`."""
    for words in ("blocks of keys", "block of keys"):
        if key.sections and words in key.holds:
            return key.holds.replace(words, f"[{words}](#{inside})")
    return key.holds


def _escaped(text: str) -> str:
    """Return a text whose angle brackets Markdown does not take for HTML."""
    return text.replace("<", "&lt;").replace(">", "&gt;")
