# `make study`, `make test`, `make smoke`: each does all set-up first, into .venv, from requirements.lock. `make judges` runs the tests that
# hold the project against other codes, in .venv-judges, from requirements-judges.lock (Python 3.11 on Linux; CalculiX, if wanted: ccx on the PATH).
# Needs Python 3.11 or newer with venv and pip. PYTHON, JOBS and CONFIG can be given: `make study JOBS=8 CONFIG=config/mine.yaml`.

PYTHON ?= python3
JOBS ?= $(shell $(PYTHON) -c "import os; print(os.cpu_count() or 2)")
CONFIG ?= config/study.yaml

VENV := .venv
BIN := $(VENV)/bin
# Named after the content of the lock, so that a changed lock, and nothing else, makes the environment anew.
STAMP := $(VENV)/ready-$(shell $(PYTHON) -c "import hashlib; print(hashlib.sha256(open('requirements.lock', 'rb').read()).hexdigest()[:16])")

JUDGES := .venv-judges
JUDGES_STAMP := $(JUDGES)/ready-$(shell $(PYTHON) -c "import hashlib; print(hashlib.sha256(open('requirements-judges.lock', 'rb').read()).hexdigest()[:16])")

.PHONY: study smoke test judges setup clean

study: $(STAMP)
	@test -f $(CONFIG) || { echo "CONFIG=$(CONFIG) is not a file: give the path of a configuration, such as config/study.yaml"; exit 1; }
	$(BIN)/snakemake -j$(JOBS) --configfile $(CONFIG)

smoke: $(STAMP)
	$(BIN)/snakemake -j$(JOBS) --configfile config/smoke.yaml

test: $(STAMP)
	$(BIN)/python -m pytest

judges: $(JUDGES_STAMP)
	$(JUDGES)/bin/python -m pytest tests/judges -rs

setup: $(STAMP)

$(STAMP):
	@$(PYTHON) -c "import sys; sys.version_info >= (3, 11) or sys.exit('Python 3.11 or newer is needed, this is ' + sys.version.split()[0] + ': make PYTHON=python3.11')"
	rm -rf $(VENV)
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes -r requirements.lock
	@# The library itself: its folder on the path, so that an edit counts at once.
	@$(BIN)/python -c "import pathlib, sysconfig; pathlib.Path(sysconfig.get_path('purelib'), 'vibroimpact.pth').write_text(str(pathlib.Path('src').resolve()) + '\n')"
	@touch $@

$(JUDGES_STAMP):
	@$(PYTHON) -c "import sys; sys.version_info >= (3, 11) or sys.exit('Python 3.11 or newer is needed, this is ' + sys.version.split()[0] + ': make PYTHON=python3.11')"
	rm -rf $(JUDGES)
	$(PYTHON) -m venv $(JUDGES)
	$(JUDGES)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes -r requirements-judges.lock
	@# The library itself: its folder on the path, so that an edit counts at once.
	@$(JUDGES)/bin/python -c "import pathlib, sysconfig; pathlib.Path(sysconfig.get_path('purelib'), 'vibroimpact.pth').write_text(str(pathlib.Path('src').resolve()) + '\n')"
	@touch $@

clean:
	rm -rf results/*/ .snakemake
