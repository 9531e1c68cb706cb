# make paper   the paper's identification procedure, from excitation to build/paper/report.html
# make test    the whole test suite
# make lint    ruff and mypy
# make bench   start-up, time per sample, memory
# make bench-differentiators   every differentiator and its peers on known signals
# make crossvalidate           online identification of twenty simulated experiments
# make emps EMPS=emps_train.csv   every differentiator on the real EMPS log
# make docs    docs/tables.md from schemas/
# make samples the small log and parameters under samples/
# make clean   remove what the above made
#
# Each does all of its own set-up; it needs Python 3.11 or newer, and a C compiler for speed.

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
PIP    := $(BIN)/python -m pip --disable-pip-version-check --quiet
SCARID := $(BIN)/scarid

.PHONY: all paper test lint bench bench-differentiators crossvalidate emps docs samples clean
.DELETE_ON_ERROR:

all: paper

# --- set-up -------------------------------------------------------------------------------------

BUILD_FILES := pyproject.toml setup.py $(wildcard scarid_cli/kernels/*.p*)

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "scarid needs Python 3.11 or newer; try make PYTHON=python3.12")'
	$(PYTHON) -m venv $(VENV)

$(VENV)/installed: $(BUILD_FILES) | $(BIN)/python
	$(PIP) install --editable .
	$(SCARID) --version
	@touch $@

$(VENV)/tested: $(VENV)/installed
	$(PIP) install --editable '.[test,lint]'
	@touch $@

test: $(VENV)/tested
	$(BIN)/python -m pytest

lint: $(VENV)/tested
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: $(VENV)/tested
	$(BIN)/python benchmarks/bench.py

$(VENV)/compared: $(VENV)/tested
	$(PIP) install --editable '.[compare]'
	@touch $@

bench-differentiators: $(VENV)/compared
	$(BIN)/python benchmarks/differentiators.py

crossvalidate: $(VENV)/tested
	$(BIN)/python benchmarks/crossvalidation.py

EMPS ?= ../shared/data/emps/emps_train.csv
emps: $(VENV)/tested
	$(BIN)/python benchmarks/emps.py $(EMPS)

docs: $(VENV)/installed
	$(BIN)/python -m scarid_cli.reporting.schemas > docs/tables.md

clean:
	rm -rf build $(VENV) *.egg-info .hypothesis .pytest_cache .mypy_cache .ruff_cache
	rm -f scarid_cli/kernels/*.so

# --- the paper's procedure ------------------------------------------------------------------------
#
# METHOD.direct.*: on the identification trajectory; METHOD.cross.*: on another one.

P       := build/paper
METHODS := ed-fir 2smd astd p2smd
RESULTS := $(foreach m,$(METHODS),$(P)/$m.parameters.parquet $(P)/$m.trace.parquet \
             $(foreach e,direct cross,$(P)/$m.$e.metrics.parquet $(P)/$m.$e.prediction.parquet))

SEED_direct := 1
SEED_cross  := 2

paper: $(P)/report.html

$(P)/report.html: $(RESULTS)
	$(SCARID) report $^ --html $@ --markdown $(P)/report.md --title "The paper's procedure"
	@echo; echo "With figures: $@"

$(P)/%.trajectory.parquet: $(VENV)/installed
	@mkdir -p $(P)
	$(SCARID) trajgen --robot scara2 --seed $(SEED_$*) -o $@

$(P)/%.log.parquet: $(P)/%.trajectory.parquet
	$(SCARID) simulate --seed $(SEED_$*) $< -o $@

$(P)/%.filtered.parquet: $(P)/%.log.parquet
	$(SCARID) filter --natural-frequency 2 $< -o $@

$(P)/%.direct.motion.parquet: $(P)/direct.filtered.parquet
	$(SCARID) differentiate --no-match --method $* $< -o $@

$(P)/%.cross.motion.parquet: $(P)/cross.filtered.parquet
	$(SCARID) differentiate --no-match --method $* $< -o $@

$(P)/%.parameters.parquet $(P)/%.trace.parquet: $(P)/%.direct.motion.parquet
	$(SCARID) identify --estimator rls --trace $(P)/$*.trace.parquet $< -o $(P)/$*.parameters.parquet

define VALIDATE
$(P)/%.$1.metrics.parquet $(P)/%.$1.prediction.parquet: $(P)/%.$1.motion.parquet $(P)/%.parameters.parquet
	$(SCARID) validate --parameters $(P)/$$*.parameters.parquet \
	  --predictions $(P)/$$*.$1.prediction.parquet $$< -o $(P)/$$*.$1.metrics.parquet
endef
$(foreach e,direct cross,$(eval $(call VALIDATE,$e)))

# Keep every table on the way: each can be looked at with `scarid info` or `scarid convert`.
.SECONDARY:

# --- samples --------------------------------------------------------------------------------------

samples: $(VENV)/installed
	$(SCARID) trajgen --seed 1 --duration 5 --rate 100 --format arrow | \
	  $(SCARID) simulate --seed 1 --log-rate 100 --format arrow | \
	  $(SCARID) convert -o samples/scara2.csv
	$(SCARID) filter --zero-phase --cutoff 8 samples/scara2.csv | \
	  $(SCARID) differentiate --method central | \
	  $(SCARID) identify --estimator ls -o samples/scara2.parameters.csv
