"""The workflow as a plan: what runs, what reruns after a change, what is said when the
configuration is wrong.

The scripts are replaced by ones that import the same files and write empty outputs, so that a whole
study takes seconds.
"""

import ast
import json
import os
import pty
import re
import shutil
import subprocess
from collections import Counter
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
import yaml

from tests.support.snakemake_runs import command, snakemake
from tests.support.sound_campaign import sound_campaign
from vibroimpact.campaign.file import write_campaign
from vibroimpact.config.reading import check_config
from vibroimpact.io.provenance import config_digest
from vibroimpact.io.records import write_record

ROOT = Path(__file__).parents[2]
STUB = """\
import os, sys
from pathlib import Path
if False:
{imports}
if snakemake.rule.strip("_").split("_from_")[0] == os.environ.get("STUDY_FAILS_AT"):
    sys.exit("stopped on purpose")
for path in snakemake.output:
    Path(path).write_text(snakemake.rule)
"""
FIGURES = {"figures_model", "figures_response", "figures_identification", "figures_checks"}
AFTER_SPECTRA = {
    "identify",
    "consistency",
    "figures_response",
    "figures_identification",
    "figures_checks",
    "study_page",
    "all",
}


class Study:
    """A copy of the workflow in a folder of its own, with a study of two loads, one gap and two
    seeds.
    """

    def __init__(self, folder):
        self.folder = folder
        ignore = shutil.ignore_patterns("__pycache__")
        for name in ("src", "workflow", "config", "examples", "evidence"):
            shutil.copytree(ROOT / name, folder / name, ignore=ignore)
        shutil.copy(ROOT / "Snakefile", folder)
        (folder / "profiles").symlink_to(Path("workflow", "profiles"))
        for script in (folder / "workflow" / "scripts").glob("*.py"):
            imports = [
                f"    {ast.unparse(node)}"
                for node in ast.parse(script.read_text()).body
                if isinstance(node, (ast.Import, ast.ImportFrom))
            ]
            script.write_text(STUB.format(imports="\n".join(imports)))
        self.values = yaml.safe_load((ROOT / "config" / "smoke.yaml").read_text())
        self.values["grid"] = {"load_rms_N": [0.5, 4.0], "gap_m": [1e-4], "seeds": 2}
        self.results = folder / "results" / "smoke"

    def snakemake(self, *arguments, values=None, **environment):
        """Run snakemake with a configuration; returns the finished process."""
        (self.folder / "mine.yaml").write_text(yaml.safe_dump(values or self.values))
        clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        given = (*arguments, "--configfile", "mine.yaml")
        return snakemake(self.folder, *given, env=clean | environment)

    def on_a_terminal(self, *arguments, **environment):
        """Run snakemake with its output on a terminal; returns what the terminal got."""
        (self.folder / "mine.yaml").write_text(yaml.safe_dump(self.values))
        ours, theirs = pty.openpty()
        clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        started = subprocess.Popen(
            command(*arguments, "--configfile", "mine.yaml"),
            cwd=self.folder,
            env=clean | {"TERM": "xterm", "COLUMNS": "120"} | environment,
            stdin=subprocess.DEVNULL,
            stdout=theirs,
            stderr=theirs,
        )
        os.close(theirs)
        told = b""
        with suppress(OSError):  # Linux ends the stream of a closed terminal with an error
            while piece := os.read(ours, 65536):
                told += piece
        os.close(ours)
        assert started.wait() == 0, told
        return told.decode()

    def plan(self, *arguments, values=None):
        """Return {rule: number of jobs} of a dry run, {} when nothing is to be done."""
        run = self.snakemake("--dry-run", *arguments, values=values)
        assert run.returncode == 0, run.stdout + run.stderr
        counts = jobs_of(run)
        counts.pop("total", None)
        return counts

    def changed(self, **sections):
        """The configuration with keys of some sections replaced."""
        return {
            **self.values,
            **{name: {**self.values[name], **keys} for name, keys in sections.items()},
        }

    def plan_after_edit(self, name):
        """The rules that would run after an edit of one library file, which is then undone."""
        file = self.folder / "src" / "vibroimpact" / name
        text = file.read_text()
        file.write_text(text + "\n# an edit\n")
        try:
            return set(self.plan())
        finally:
            file.write_text(text)


def jobs_of(run):
    """Return {rule: number of jobs} of the table that a dry run prints, without the underscore of
    internal rules. The rules identify_from_... count as one.
    """
    counts = Counter()
    for rule, count in dict(
        re.findall(r"^([\w.]+) +(\d+)$", run.stdout + run.stderr, flags=re.M)
    ).items():
        counts[rule.removeprefix("_").split("_from_")[0]] += int(count)
    return dict(counts)


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """A study that has been interrupted at its identification, continued, and is complete."""
    study = Study(tmp_path_factory.mktemp("study"))
    study.stopped = study.snakemake("-j2", "--keep-going", STUDY_FAILS_AT="identify")
    study.plan_when_stopped = study.plan()
    study.finished = study.snakemake("-j2")
    return study


def test_the_default_study_is_planned_with_one_job_per_load(study):
    plan = study.plan(values=yaml.safe_load((ROOT / "config" / "study.yaml").read_text()))
    once = {"basis", "synthetic_campaign", "consistency", "study_page", "all"} | FIGURES
    assert plan == {"simulate_to_spectra": 24, "identify": 6, **dict.fromkeys(once, 1)}


@pytest.mark.slow
def test_loads_are_identified_by_half_decade(study):
    plan = study.plan(values=study.changed(grid={"load_rms_N": [0.5, 1.5, 3.1, 3.2, 4.0]}))
    assert plan["simulate"] == plan["spectra"] == 3
    assert plan["identify"] == 2  # 1.5 and 3.1 N are new; 3.2 N joins 4 N; that of 0.5 N stays


def test_an_interrupted_study_continues_where_it_stopped(study):
    assert study.stopped.returncode != 0
    assert "stopped on purpose" in study.stopped.stderr
    done = {"basis", "simulate", "spectra", "figures_model", "figures_response"}
    assert (
        set(study.plan_when_stopped)
        == {
            "identify",
            "consistency",
            "figures_identification",
            "figures_checks",
            "study_page",
            "all",
        }
        - done
    )
    assert study.plan_when_stopped["identify"] == 2
    assert study.finished.returncode == 0, study.finished.stderr


def test_complete_study_has_tables_figures_and_no_jobs_left(study):
    for name in (
        "consistency.csv",
        "consistency_summary.csv",
        "consistency.nc",
        "index.html",
        "basis_quality.csv",
        "figures/figure_01_layout.png",
    ):
        assert (study.results / name).is_file()
    assert len(list((study.results / "records").glob("load_*_gap_0.0001_seed_*.nc"))) == 4
    assert study.plan() == {}


def test_a_run_leaves_its_configuration_and_provenance(study):
    written = yaml.safe_load((study.results / "config.yaml").read_text())
    assert written == check_config(study.values, "mine").model_dump(mode="json")
    provenance = json.loads((study.results / "provenance.json").read_text())
    assert provenance["config_digest"] == config_digest(written)
    assert provenance["command"].endswith("-j2 --configfile mine.yaml")
    assert study.plan(values=written) == {}  # it runs again as it stands, and nothing is to be done


def test_a_failed_run_names_case_log_and_remedy(study):
    told = study.stopped.stderr
    assert "2 jobs failed:" in told
    assert "  Identification at 4 N RMS: 2 of 4 cases (rule identify_from_4)" in told
    assert "results/smoke/logs/identify_from_4.log is empty" in told
    assert "give the same command again" in told


def test_a_terminal_shows_a_bar_and_a_pipe_plain_lines(study):
    again = ("-j1", "--forcerun", "all")
    told = study.on_a_terminal(*again)
    assert "1 of 1 jobs" in told and "━" in told
    assert "✓ Study 'smoke' is complete" in told and "Finished jobid" not in told
    piped = study.snakemake(*again)
    assert piped.returncode == 0 and "1 of 1 steps (100%) done" in piped.stderr
    assert "✓" not in piped.stderr and "\x1b" not in piped.stderr


@pytest.mark.parametrize(
    ("file", "expected"),
    [
        ("identify/spectra/welch.py", {"spectra"} | AFTER_SPECTRA),
        ("config/checks.py", set()),
    ],
)
def test_edited_file_reruns_the_stages_that_import_it(study, file, expected):
    assert study.plan_after_edit(file) == expected


def test_an_added_load_simulates_only_what_is_new(study):
    plan = study.plan(values=study.changed(grid={"load_rms_N": [0.5, 1.5, 4.0]}))
    assert plan["simulate"] == plan["spectra"] == plan["identify"] == 1
    assert "basis" not in plan


@pytest.mark.slow
def test_added_load_without_series_simulates_only_new_cases(study):
    values = {**study.changed(record={"keep_time_series": False}), "study": "added"}
    assert study.snakemake("-j2", values=values).returncode == 0
    assert study.plan(values=values) == {}
    plan = study.plan(values={**values, "grid": {**values["grid"], "load_rms_N": [0.5, 3.5, 4.0]}})
    assert plan["simulate_to_spectra"] == plan["identify"] == 1 and not {
        "basis",
        "simulate",
        "spectra",
    } & set(plan)


def test_a_changed_key_reruns_the_stages_that_use_it(study):
    assert (
        set(study.plan(values=study.changed(spectra={"overlap": 0.5})))
        == {"spectra"} | AFTER_SPECTRA
    )
    assert (
        set(study.plan("--config", "seed=7"))
        == {"simulate", "synthetic_campaign", "spectra"} | AFTER_SPECTRA
    )


@pytest.mark.slow
def test_the_timing_is_made_on_request_from_all_jobs(study):
    assert study.plan("timing") == {"timing": 1}
    run = study.snakemake("-j2", "timing")
    assert run.returncode == 0, run.stderr
    assert (study.results / "timing.csv").is_file() and (
        study.results / "figures" / "timing.png"
    ).is_file()
    assert study.plan() == {}


@pytest.mark.slow
def test_edited_figure_or_method_reruns_no_simulation(study):
    after_figure = {"figures_identification", "study_page", "all"}
    assert study.plan_after_edit("reports/figures/study/shapes.py") == after_figure
    assert study.plan_after_edit("identify/lscf.py") == {
        "identify",
        "consistency",
        "figures_identification",
        "figures_checks",
        "study_page",
        "all",
    }
    assert study.plan_after_edit("reports/study_words.py") == {"study_page", "all"}


@pytest.mark.slow
def test_time_series_are_written_only_where_they_are_kept(study):
    assert len(list((study.results / "timeseries").glob("*.nc"))) == 4
    values = {**study.changed(record={"keep_time_series": False}), "study": "short"}
    series = "results/short/timeseries"
    run = study.snakemake("-j2", "results/short/spectra/load_4_gap_0.0001_seed_0.nc", values=values)
    assert run.returncode == 0, run.stderr
    assert (study.folder / "results/short/records/load_4_gap_0.0001_seed_0.nc").is_file()
    assert list((study.folder / series).glob("*.nc")) == []
    assert "simulate_to_spectra" in run.stderr + run.stdout


def test_wrong_configuration_is_reported_before_any_plan(study):
    run = study.snakemake(
        "--dry-run", values=study.changed(spectra={"overlp": 0.5}, record={"duration_s": 1.0})
    )
    told = run.stdout + run.stderr
    assert run.returncode == 1
    assert "mine.yaml: unknown key 'overlp' in spectra: did you mean 'overlap'?" in told
    assert "mine.yaml: spectra.segment_s = 4.0 is longer than the record, 1 s" in told
    assert "Traceback" not in told and "Building DAG" not in told


@pytest.mark.parametrize(
    ("target", "asked", "owner"),
    [
        ("discrepancy", "campaign={}/smoke.nc", "the folder of the study 'smoke'"),
        ("import_campaign", "import={}/validation", "which the target validation writes"),
    ],
)
def test_results_of_another_target_are_not_overwritten(study, tmp_path, target, asked, owner):
    write_campaign(sound_campaign(), tmp_path / Path(asked.partition("/")[2]).name)
    run = study.snakemake("--dry-run", target, "--config", asked.format(tmp_path))
    told = run.stdout + run.stderr
    assert run.returncode == 1 and owner in told and "give it another name" in told
    assert "Building DAG" not in told and "Traceback" not in told


def test_problems_of_an_import_are_one_paragraph_and_a_draft(study, tmp_path):
    (tmp_path / "bench").mkdir()
    (tmp_path / "bench" / "run.csv").write_text("time [s],F [N]\n0,1\n0.001,2\n0.002,3\n")
    run = study.snakemake("-c1", "import_campaign", "--config", f"import={tmp_path}/bench")
    told = (run.stdout + run.stderr).strip().split("\n")
    assert run.returncode == 1 and not any("rule" in line or "Error" in line for line in told)
    draft = "results/bench/campaign.draft.yaml"
    assert told[-2].startswith(f"{tmp_path}/bench: there is no campaign.yaml, and the files do not")
    assert told[-1].startswith(f"{draft} is a draft of campaign.yaml: complete it")
    assert '{name: "F", variable: "F", unit: "N"' in (study.folder / draft).read_text()


def test_campaign_faults_are_reported_before_any_job(study, tmp_path):
    campaign = sound_campaign()
    write_campaign(campaign, tmp_path / "bench.nc")
    campaign["gap"].values[:] = [0.289, -1.0, np.nan]
    campaign["record_name"].values[2] = "low"
    write_record(campaign, tmp_path / "wrong.nc", names_kept=True)
    (tmp_path / "text.nc").write_text("nothing")
    for target, file, parts in (
        ("quicklook", "wrong.nc", ("gap[1] = -1 m is negative", "record_name[2] = 'low'")),
        ("discrepancy", "text.nc", ("text.nc: can not be read as netCDF",)),
    ):
        run = study.snakemake("--dry-run", target, "--config", f"campaign={tmp_path}/{file}")
        told = run.stdout + run.stderr
        assert run.returncode == 1 and all(part in told for part in parts), told
        assert "Traceback" not in told and "delete it" not in told


def test_a_campaign_without_a_model_is_planned_as_any(study, tmp_path):
    write_campaign(sound_campaign(), tmp_path / "bench.nc")
    (tmp_path / "own.yaml").write_text("structure: {kind: identified, band_Hz: [5, 60]}")
    given = (f"campaign={tmp_path}/bench.nc", f"model={tmp_path}/own.yaml")
    run = study.snakemake("--dry-run", "discrepancy", "--config", *given)
    assert run.returncode == 0, run.stdout + run.stderr
    assert set(jobs_of(run)) - {"total"} == {"diagnosis", "discrepancy_report", "discrepancy"}


def test_measured_supports_are_one_job(study, tmp_path):
    """A force is not needed."""
    campaign = sound_campaign()
    force = [name for name in campaign.variables if str(name).startswith("force")]
    write_record(campaign.drop_vars([*force, "load_rms"]), tmp_path / "plant.nc", names_kept=True)
    asked = ("--dry-run", "equivalent", "--config", f"equivalent_of={tmp_path}/plant.nc")
    run = study.snakemake(*asked)
    assert run.returncode == 0, run.stdout + run.stderr
    assert set(jobs_of(run)) - {"total"} == {"equivalent"}


def test_what_gives_no_supports_is_told_before_any_plan(study, tmp_path):
    write_campaign(sound_campaign(), tmp_path / "bench.nc")
    asked = (f"equivalent_of={tmp_path}/bench.nc", "model=identified")
    run = study.snakemake("--dry-run", "equivalent", "--config", *asked)
    said = run.stdout + run.stderr
    assert run.returncode == 1 and "model = 'identified' has no supports to identify" in said
    assert "Traceback" not in said


def test_search_is_one_job_of_standard_effort(study, tmp_path):
    write_campaign(sound_campaign(), tmp_path / "bench.nc")
    asked = ("--dry-run", "discrepancy", "--config", f"campaign={tmp_path}/bench.nc")
    run = study.snakemake(*asked)
    assert set(jobs_of(run)) - {"total"} == {"diagnosis", "discrepancy_report", "discrepancy"}
    assert "effort standard" in run.stdout + run.stderr


@pytest.mark.slow
def test_shard_skips_imported_campaigns(study, tmp_path):
    asked = [
        "--dry-run",
        "acceptance",
        "--config",
        "draw_seed=5",
        "count=9",
        "shard=1/3",
    ]  # campaigns 1, 4 and 7
    (tmp_path / "campaigns.csv").write_text("draw,campaign\ndevelopment_5,campaign_0004\n")
    for more, judged in ((), 3), ((f"add={tmp_path}/campaigns.csv",), 2):
        assert jobs_of(study.snakemake(*asked, *more))["acceptance_campaign"] == judged
    run = study.snakemake(
        "--dry-run", "acceptance", "--config", "draw_seed=6", f"add={tmp_path}/campaigns.csv"
    )
    assert (
        run.returncode == 1
        and "holds campaigns of development_5: give a campaigns.csv of development_6"
        in run.stdout + run.stderr
    )


@pytest.mark.slow
def test_lint_has_no_advice_but_on_conda_and_containers(study):
    run = study.snakemake("--lint")
    advice = set(re.findall(r"^ +\* (.*)$", run.stdout + run.stderr, flags=re.M))
    assert advice == {"Specify a conda environment or container for each rule.:"}
