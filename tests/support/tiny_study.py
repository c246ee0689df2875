"""A study of seconds, whose scripts run in this process: every kind of file that a study writes."""

import runpy
import sys
from copy import deepcopy
from pathlib import Path
from types import SimpleNamespace

import yaml

from vibroimpact.config.reading import check_config
from vibroimpact.config.stage_keys import answer_digest, stage_params
from vibroimpact.study.cases import all_cases, load_values, nearest_loads, value_text

ROOT = Path(__file__).parents[2]
SCRIPTS = ROOT / "workflow" / "scripts"
SOURCE_DIGEST = "0a1b2c3d4e5f6789"
FIGURES = ("model", "response", "identification", "checks")


def tiny_values(**changes):
    """The configuration of the smoke test with a record of 8 s, two loads and one gap; top-level
    keys are replaced by `changes`.
    """
    values = yaml.safe_load((ROOT / "config" / "smoke.yaml").read_text())
    values |= {
        "study": "tiny",
        "grid": {"load_rms_N": [4.0, 20.0], "gap_m": [1e-4], "seeds": 2},
        "overlay": values["overlay"] | {"load_rms_N": [4.0]},
    }
    values["record"]["duration_s"] = 8.0
    values["spectra"]["segment_s"] = 2.0
    values["integration"]["start_up_s"] = 0.5
    return values | deepcopy(changes)


class TinyStudy:
    """The files of a study in a folder of its name, made by the scripts of the workflow.

    values: a configuration, as YAML gives it.
    """

    def __init__(self, folder, values):
        self.config = check_config(values, "the tiny study")
        self.folder = Path(folder) / self.config.study
        self.loads = [value_text(load) for load in load_values(self.config.grid)]
        for name in ("logs", "records", "timeseries", "spectra", "estimates", "figures"):
            (self.folder / name).mkdir(parents=True, exist_ok=True)

    def files(self, kind, suffix="nc", load=None):
        """The files of a kind of all cases, or of those of one load."""
        return [
            str(self.folder / kind / f"{case.id}.{suffix}")
            for case in all_cases(self.config.grid)
            if load is None or value_text(case.load_rms_N) == load
        ]

    def path(self, name):
        """A file of the study by its name."""
        return str(self.folder / name)

    def run(self, stage, inputs, outputs, load="", **params):
        """Run the script of a stage, with the settings that its rule gives it."""
        log = self.folder / "logs" / f"{stage}{load}.log"
        job = SimpleNamespace(
            input=SimpleNamespace(**inputs),
            output=SimpleNamespace(**outputs),
            params=SimpleNamespace(
                library=SOURCE_DIGEST, config=stage_params(self.config, stage), **params
            ),
            log=[str(log)],
        )
        streams = sys.stdout, sys.stderr
        try:
            runpy.run_path(str(SCRIPTS / f"{stage}.py"), {"snakemake": job})
        finally:
            if sys.stdout is not streams[0]:
                sys.stdout.close()
            sys.stdout, sys.stderr = streams

    def simulate(self):
        """The model, and the records, time series and spectra of every case."""
        model = self.path("model.nc")
        outputs = {
            "model": model,
            "quality": self.path("basis_quality.csv"),
            "accuracy": self.path("model_accuracy.csv"),
        }
        self.run("basis", {}, outputs)
        for load in self.loads:
            series, spectra = (self.files(kind, load=load) for kind in ("timeseries", "spectra"))
            outputs = {"records": self.files("records", load=load), "series": series}
            self.run("simulate", {"model": model}, outputs, load)
            if self.config.identification is not None:
                self.run("spectra", {"series": series}, {"spectra": spectra}, load)

    def identify(self):
        """The estimates of every case, the consistency tables, the campaign laid over them."""
        model, table = self.path("model.nc"), self.path("consistency.csv")
        tables = self.files("estimates", "csv")
        self.run(
            "identify",
            {"model": model, "records": self.files("records"), "spectra": self.files("spectra")},
            {"curves": self.files("estimates"), "tables": tables},
        )
        names = ("summary", "collapse")
        outputs = {name: self.path(f"consistency_{name}.csv") for name in names}
        outputs |= {"table": table, "dataset": self.path("consistency.nc")}
        outputs["equivalent"] = self.path("equivalent.csv")
        digest = answer_digest(self.config.model_dump(mode="json"))
        self.run("consistency", {"model": model, "tables": tables}, outputs, digest=digest)
        self.run(
            "synthetic_campaign",
            {"model": model},
            {"campaign": self.path("synthetic_campaign.nc")},
            loads=nearest_loads(self.config.grid, self.config.overlay.load_rms_N),
        )
        self.run(
            "statistics", {"records": self.files("records")}, {"table": self.path("statistics.csv")}
        )

    def draw(self, groups=FIGURES):
        """The figures of some groups."""
        inputs = {
            "model": self.path("model.nc"),
            "quality": self.path("basis_quality.csv"),
            "campaign": self.path("synthetic_campaign.nc"),
            "spectra": self.files("spectra"),
            "curves": self.files("estimates"),
            "records": self.files("records"),
            "table": self.path("consistency.csv"),
        }
        for group in groups:
            self.run(f"figures_{group}", inputs, {"figures": [self.path("figures/any.png")]})
