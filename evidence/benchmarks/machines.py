"""The table of machines that the benchmark ran on: ours against the plain loop and the limit."""

from pathlib import Path

from evidence.benchmarks.pairs import BATCH, ONE_RUN, PEAK
from evidence.benchmarks.table import NANOSECONDS, read_csv, three_digits, write_csv

FILE = Path(__file__).with_name("machines.csv")
COLUMNS = (
    "target",
    "vector_bits",
    "GFLOPs",
    "case",
    "one_run",
    "batch_of_8",
    "peak_share",
    "ns_per_step",
)
PLAIN = "plain numba loop"


def keep_machine(rows, target, peak):
    """Write rows (table.COLUMNS) of this target (of LLVM) to FILE, in the place of its former
    ones; peak: (GFLOP/s, bits of a vector) of one core.
    """
    own = machine_rows(rows, target, peak)
    measured = {(target, row["case"]) for row in own}
    known = [row for row in read_csv(FILE) if (row["target"], row["case"]) not in measured]
    ordered = sorted([*known, *own], key=lambda row: (row["target"], row["case"]))
    write_csv(FILE, COLUMNS, ordered)


def machine_rows(rows, target, peak):
    """Return [{column: value}] of the cases that were measured against the plain loop and the peak,
    one run and a batch of eight.
    """
    found = {
        (row["case"], row["peer"], row["quantity"]): row
        for row in rows
        if row["unit"] == NANOSECONDS
    }
    (GFLOPs, bits), out = peak, []
    for case in dict.fromkeys(row["case"] for row in rows):
        eight = BATCH.format(8)
        wanted = [(case, PLAIN, ONE_RUN), (case, PLAIN, eight), (case, PEAK, eight)]
        if all(key in found for key in wanted):
            one, batch, limit = (found[key] for key in wanted)
            ratios = [row["ratio_median"] for row in (one, batch, limit)]
            values = (target, bits, GFLOPs, case, *ratios, batch["ours_median"])
            out.append(dict(zip(COLUMNS, values, strict=True)))
    return out


def machine_list():
    """Return the page's list, one line for each machine."""
    cases: dict[tuple, list[str]] = {}
    for row in read_csv(FILE):
        ratios = [three_digits(float(row[name])) for name in ("one_run", "batch_of_8")]
        share, ns = 100.0 * float(row["peak_share"]), float(row["ns_per_step"])
        machine = row["target"], row["vector_bits"], three_digits(float(row["GFLOPs"]))
        cases.setdefault(machine, []).append(
            f"{row['case'].partition(',')[0]}: {'; '.join(ratios)}; {share:.2g} %; {ns:.0f}"
        )
    return "".join(
        f"- `{target}`, {bits} bits, {rate} GFLOP/s. {'. '.join(own)}.\n"
        for (target, bits, rate), own in cases.items()
    )
