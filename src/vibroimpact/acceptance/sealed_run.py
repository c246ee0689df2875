"""One sealed campaign of the suite, from its file to its verdict."""

from pathlib import Path

from vibroimpact.discrepancy.whole import run_campaign


def left_out(plan_effects, arm):
    """Return the ids to take out of the catalogue for a campaign of the arm left_out."""
    return {name for name, _ in plan_effects} if arm == "left_out" else set()


def run_sealed(values, folder, bank, tables, without=frozenset(), draw=0):
    """Run the campaign in a folder against a configuration with the candidates of a bank, those of
    some ids left out; the campaign file is then dropped.

    draw: number of the draw of seeds.
    """
    folder = Path(folder)
    run_campaign(
        values,
        folder / "campaign.nc",
        folder,
        {},
        bank=bank,
        tables=tables,
        without=without,
        draw=draw,
    )
    (folder / "campaign.nc").unlink()
