"""The catalogue of effects as a page of the documentation."""

from vibroimpact.effects.effect import SCALES, TESTS, WHERE, Effect, Parameter
from vibroimpact.effects.registry import EFFECTS


def markdown() -> str:
    """Return the catalogue as Markdown, generated from the registry: a section per effect."""
    parts = ["# Catalogue of effects", INTRODUCTION]
    for group in WHERE:
        members = [effect for effect in EFFECTS.values() if effect.acts_on == group]
        parts.append(f"## {group.capitalize()}")
        parts += [_section(effect) for effect in members]
    return "\n\n".join(parts) + "\n"


INTRODUCTION = """An effect is a change of the configuration of a model. The catalogue holds
every effect that a verdict can name. In the laws, p is the indentation of a contact, k its
stiffness, u a displacement, v a velocity and a an acceleration. Bounds are multiples of a size of
the structure or the campaign, so that they mean the same on any structure."""


def _section(effect: Effect) -> str:
    """Return the section of an effect."""
    rows = [
        "| parameter | meaning | unit | bounds | without the effect |",
        "| --- | --- | --- | --- | --- |",
        *map(_row, effect.parameters),
    ]
    broken = ", ".join(f"{test} ({TESTS[test]})" for test in effect.broken)
    facts = {
        "In reports": effect.called,
        "Family": effect.family,
        "Law": effect.law,
        "Reported as": f"`{effect.law_of}`" if effect.law_of else "",
        "Breaks": broken or "none of the invariances",
        "Similar to": ", ".join(f"`{name}`" for name in effect.aliases),
        "Needs": ", ".join(effect.needs),
        "Source": effect.source,
    }
    return "\n".join(
        [
            f"### `{effect.id}`",
            "",
            f"{effect.explanation[0].upper()}{effect.explanation[1:]}.",
            "",
            *rows,
            "",
            *(f"- {name}: {text}." for name, text in facts.items() if text),
        ]
    )


def _row(parameter: Parameter) -> str:
    """Return the row of a parameter in the table of its effect."""
    bounds = f"{parameter.low:g} to {parameter.high:g}"
    if parameter.per != "one":
        bounds += f" times {SCALES[parameter.per]}"
    if parameter.over:
        bounds += f", as a multiple of `{parameter.over}`"
    neutral = "no such value" if parameter.neutral is None else f"{parameter.neutral:g}"
    unit = "-" if parameter.unit == "1" else parameter.unit
    return f"| `{parameter.name}` | {parameter.meaning} | {unit} | {bounds} | {neutral} |"
