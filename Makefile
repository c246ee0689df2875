# `make` lists the targets. Each sets up the environment that it needs first, from a lock file.
# Needs Python 3.11 or newer with venv and pip. PYTHON, JOBS and CONFIG can be given:
# `make study JOBS=8 CONFIG=config/mine.yaml`.

PYTHON ?= python3
JOBS ?= $(shell $(PYTHON) -c "import os; print(os.cpu_count() or 2)")
CONFIG ?= config/study.yaml

BIN := .venv/bin
# A stamp is named after the content of the base lock and of the one that adds to it: a change of
# these, and nothing else, makes the environment anew. (1) environment, (2) lock.
digest = $(shell $(PYTHON) -c "import hashlib; print(hashlib.sha256(b''.join(open(name, 'rb') \
	.read() for name in sorted({'requirements.lock', '$(1)'}))).hexdigest()[:16])")
stamp = $(1)/ready-$(call digest,$(2))
READY := $(call stamp,.venv,requirements.lock)
READY_JUDGES := $(call stamp,.venv-judges,requirements-judges.lock)
READY_BENCHMARK := $(call stamp,.venv-benchmark,requirements-benchmark.lock)
READY_DOCS := $(call stamp,.venv-docs,requirements-docs.lock)

# An environment (1) from a lock (2), with the library's own folder on its path.
define environment
@$(PYTHON) -c "import sys; sys.version_info >= (3, 11) or sys.exit('Python 3.11 or newer is' \
	' needed, this is ' + sys.version.split()[0] + ': make PYTHON=python3.11')"
rm -rf $(1)
$(PYTHON) -m venv $(1)
$(1)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes \
	-r $(2)
@$(1)/bin/python workflow/put_library_on_path.py
@touch $@
endef

.DEFAULT_GOAL := help
.PHONY: help study smoke test test-slow test-all reliability lint format judges benchmark docs \
	setup clean

help: ## list the targets
	@$(PYTHON) -c "import re; [print(f'make {name:<10} {text}') for name, text in \
		re.findall(r'^([a-z-]+):.*?## (.*)', open('Makefile').read(), re.M)]"

study: $(READY) ## the study of CONFIG: simulation, spectra, identification, tables, figures
	@$(BIN)/python -m vibroimpact check $(CONFIG)
	$(BIN)/snakemake -j$(JOBS) --configfile $(CONFIG)

smoke: $(READY) ## the same study made tiny, in under a minute
	$(BIN)/snakemake -j$(JOBS) --configfile config/smoke.yaml

test: $(READY) ## the fast tier of every kind of test, in parallel
	$(BIN)/python -m pytest -n $(JOBS) --dist worksteal -m "not slow"

test-slow: $(READY) ## the tests that `make test` leaves out
	$(BIN)/python -m pytest -n $(JOBS) --dist worksteal --hypothesis-profile thorough -m slow

test-all: $(READY) ## every test, and the coverage of the library
	$(BIN)/python -m pytest -n $(JOBS) --dist worksteal --hypothesis-profile thorough \
		--cov --cov-report term

reliability: $(READY) ## the tests of faults and bad input: writes docs/reliability.md
	$(BIN)/python -m pytest -n $(JOBS) --dist worksteal --hypothesis-profile thorough \
		--reliability

lint: $(READY) ## formatting, static checks, types; sizes beside their limits
	$(BIN)/ruff format --check
	$(BIN)/ruff check
	$(BIN)/snakefmt --check Snakefile workflow evidence/rules examples src/vibroimpact/study/folder
	$(BIN)/mypy
	@$(BIN)/python tests/test_typed.py
	@$(BIN)/python -m evidence.size

format: $(READY) ## format Python files and rules
	$(BIN)/ruff check --fix --select I
	$(BIN)/ruff format
	$(BIN)/snakefmt Snakefile workflow evidence/rules examples src/vibroimpact/study/folder

# OpenSees (1: environment) finds its BLAS only where the loader looks.
opensees = LD_LIBRARY_PATH="$$(echo $(1)/lib/python3*/site-packages/openseespylinux/lib)"

judges: $(READY_JUDGES) ## tests against other codes, in an environment of their own
	$(call opensees,.venv-judges) .venv-judges/bin/python -m pytest tests/judges -rs

benchmark: $(READY_BENCHMARK) ## speed beside other codes: writes docs/performance.md
	.venv-benchmark/bin/python -m evidence.benchmarks.work_precision
	$(call opensees,.venv-benchmark) .venv-benchmark/bin/python -m evidence.benchmarks

docs: $(READY_DOCS) ## the documentation site: docs/_build/html/index.html
	.venv-docs/bin/sphinx-build -q -W --keep-going -b html docs docs/_build/html

setup: $(READY) ## only the environment

clean: ## remove the results of one study: make clean STUDY=name (imported data stay)
	@$(PYTHON) workflow/remove_study.py "$(STUDY)"

$(READY):
	$(call environment,.venv,requirements.lock)

$(READY_JUDGES):
	$(call environment,.venv-judges,requirements-judges.lock)

$(READY_BENCHMARK):
	$(call environment,.venv-benchmark,requirements-benchmark.lock)

$(READY_DOCS):
	$(call environment,.venv-docs,requirements-docs.lock)
