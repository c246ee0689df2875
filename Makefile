# `make study`, `make test`, `make smoke`: each does all set-up first, into .venv, from requirements.lock. `make judges` runs the tests that
# hold the project against other codes, in .venv-judges, from requirements-judges.lock (Python 3.11 on Linux; CalculiX, if wanted: ccx on the PATH).
# `make benchmark` measures the project beside other codes, in .venv-benchmark, from requirements-benchmark.lock, and writes docs/performance.md.
# Needs Python 3.11 or newer with venv and pip. PYTHON, JOBS and CONFIG can be given: `make study JOBS=8 CONFIG=config/mine.yaml`.

PYTHON ?= python3
JOBS ?= $(shell $(PYTHON) -c "import os; print(os.cpu_count() or 2)")
CONFIG ?= config/study.yaml

VENV := .venv
BIN := $(VENV)/bin
JUDGES := .venv-judges
BENCHMARK := .venv-benchmark
# Named after the content of the lock, so that a changed lock, and nothing else, makes the environment anew.
ready = $(1)/ready-$(shell $(PYTHON) -c "import hashlib; print(hashlib.sha256(open('$(2)', 'rb').read()).hexdigest()[:16])")
STAMP := $(call ready,$(VENV),requirements.lock)
JUDGES_STAMP := $(call ready,$(JUDGES),requirements-judges.lock)
BENCHMARK_STAMP := $(call ready,$(BENCHMARK),requirements-benchmark.lock)

# An environment (1) from a lock (2), and in it the library itself: its folder on the path, so that an edit counts at once.
define environment
@$(PYTHON) -c "import sys; sys.version_info >= (3, 11) or sys.exit('Python 3.11 or newer is needed, this is ' + sys.version.split()[0] + ': make PYTHON=python3.11')"
rm -rf $(1)
$(PYTHON) -m venv $(1)
$(1)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes -r $(2)
@$(1)/bin/python -c "import pathlib, sysconfig; pathlib.Path(sysconfig.get_path('purelib'), 'vibroimpact.pth').write_text(str(pathlib.Path('src').resolve()) + '\n')"
@touch $@
endef

.PHONY: study smoke test judges benchmark setup clean

study: $(STAMP)
	@test -f $(CONFIG) || { echo "CONFIG=$(CONFIG) is not a file: give the path of a configuration, such as config/study.yaml"; exit 1; }
	$(BIN)/snakemake -j$(JOBS) --configfile $(CONFIG)

smoke: $(STAMP)
	$(BIN)/snakemake -j$(JOBS) --configfile config/smoke.yaml

test: $(STAMP)
	$(BIN)/python -m pytest

judges: $(JUDGES_STAMP)
	$(JUDGES)/bin/python -m pytest tests/judges -rs

benchmark: $(BENCHMARK_STAMP)
	$(BENCHMARK)/bin/python -m benchmarks.work_precision
	$(BENCHMARK)/bin/python -m benchmarks

setup: $(STAMP)

$(STAMP):
	$(call environment,$(VENV),requirements.lock)

$(JUDGES_STAMP):
	$(call environment,$(JUDGES),requirements-judges.lock)

$(BENCHMARK_STAMP):
	$(call environment,$(BENCHMARK),requirements-benchmark.lock)

clean:
	rm -rf results/*/ .snakemake
