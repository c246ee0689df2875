"""Make a sealed campaign of a draw, judge it, and keep its verdict, model and truth."""

from pathlib import Path
from shutil import copy
from tempfile import TemporaryDirectory

from evidence.acceptance.sealed_run import run_sealed
from evidence.acceptance.shards import draw_of
from evidence.truth.table import files_of, make_number
from vibroimpact.io.job_log import redirect_output

redirect_output(snakemake.log[0])
number = int(snakemake.wildcards.number)
pool, seed = draw_of(snakemake.wildcards.drawn)
with TemporaryDirectory(dir=Path(snakemake.output.verdict).parent) as work:
    files = files_of(work, number)
    make_number({"pool": pool, "seed": seed}, number, work)
    run_sealed(files["campaign"], files["model"], snakemake.output.verdict)
    copy(files["model"], snakemake.output.model)
    copy(files["truth"], snakemake.output.truth)
