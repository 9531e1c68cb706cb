# make paper    the paper's identification procedure, from excitation to build/paper/report.html
# make paper-montecarlo SEEDS=50   the same over many seeds: medians, quartiles, rankings
# make test     the whole test suite
# make fuzz     the tests with generated inputs, 5000 of them each (FUZZ=...), and others each time
# make mutants  whether the tests notice a changed operator: 200 changes (two hours)
# make docs-test   the code blocks of the documentation, including those that take long
# make lint     ruff and mypy
# make faults   inject every kind of fault, and write docs/faults.md (a quarter of an hour)
# make bench    start-up, time per sample, memory
# make bench-identify  time and memory of each step of identify, on short and long logs
# make bench-latency      from a row written to its estimates read (a minute)
# make bench-excitation   optimised excitations of several robots beside random ones (an hour)
# make bench-experiments  expected errors, sequences of experiments, arms of URDFs (an hour)
# make bench-differentiators   every differentiator and its peers on known signals
# make crossvalidate   online identification of twenty simulated experiments
# make montecarlo      coverage of the stated intervals
# make bench-verdicts   whether intervals and verdicts hold under imperfect conditions
# make gauntlet       the blind procedure on four robots under all conditions (an hour)
# make bench-mixtures the blind procedure on logs with random mixtures of imperfections
# make bench-tilts    bases that lean: named, and the estimates
# make bench-gains    torques of one joint in another unit: named, and the estimates
# make bench-forgetting  parameters that change: variable forgetting beside constant factors
# make bench-friction   what `identify --friction auto` chooses, judged on another motion
# make bench-contacts   false alarms and pushes of `validate --residual`
# make bench-carried  pick-ups in logs: found when, false alarms, errors of the payload
# make bench-known-load   torque constants from a load whose mass is known: within their intervals?
# make bench-payloads  payloads of arms that are not ideal: errors, and whether intervals contain the truth
# make bench-aims   the errors of gains and payloads by motions that are planned for them
# make bench-coarse   the choice of a bandwidth where positions are coarse
# make bench-arms     random arms that nobody has chosen, identified blind
# make bench-exported  a call of the exported C file, beside Pinocchio's C++ and Python
# make bench-mujoco   the blind procedure on arms that MuJoCo moves
# make bench-checks    what check says of logs with known faults
# make bench-within   is the torque that another motion needs within what identify states?
# make bench-changed   how often validate calls a change between two logs by its name
# make emps EMPS=emps_train.csv   every differentiator on the real EMPS log
# make batch CONFIG=fleet.toml   many logs of several robots, restartable; PROFILE=slurm on a cluster
# make test-batch     the batch by Snakemake: killed, restarted, the same bytes
# make test-slurm     the same on a Slurm that runs on this machine alone
# make bench-batch LOGS=1000   a pipe, then, and a batch of a simulated fleet; PARTS="growth killed"
# make man      the man pages, into build/man
# make wheel    the source distribution and the wheel, audited, into build/dist
# make minute   from the wheel to README's first verdict in an empty environment, with times
# make docs     generate docs/tables.md and docs/beyond.md from what they describe
# make figures  the figures of the documentation (FIGURES="pipe stated": these only)
# make site     the documentation as a site that needs no network: build/site/index.html
# make samples  generate the small log and its parameters under samples/
# make clean    remove everything that the other targets made
#
# Each target does all of its own set-up. It needs Python 3.11 or newer, and a C compiler for speed.

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
PIP    := $(BIN)/python -m pip --disable-pip-version-check --quiet
SCARID := $(BIN)/scarid

.PHONY: all paper paper-montecarlo repetition test test-all docs-test lint bench bench-identify bench-latency bench-arms bench-exported bench-excitation bench-experiments bench-differentiators crossvalidate montecarlo bench-verdicts bench-coarse bench-loop bench-carried bench-known-load bench-payloads bench-aims bench-gains bench-tilts bench-forgetting bench-friction bench-contacts bench-mixtures bench-mujoco bench-checks bench-within bench-changed gauntlet emps batch test-batch test-slurm bench-batch fuzz mutants faults docs figures site man wheel minute samples clean
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

# Both marks at once: a fresh machine compiles the kernels once, and only the modules that it imports.
$(VENV)/tested: $(BUILD_FILES) | $(BIN)/python
	$(PIP) install --no-compile --editable '.[test,lint]'
	@touch $(VENV)/installed $@

# Of each process that tests start: one thread of linear algebra, and modules that are compiled once.
TESTING := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE=

test: $(VENV)/tested
	$(TESTING) $(BIN)/python -m pytest -n auto --maxprocesses 4

# Statistical tests over as many seeds as their words say, and the slow blocks of the pages.
test-all: $(VENV)/tested
	SCARID_TESTS=all SCARID_DOCS=all $(TESTING) $(BIN)/python -m pytest -n auto --maxprocesses 4

docs-test: $(VENV)/tested
	SCARID_DOCS=all $(TESTING) $(BIN)/python -m pytest -n auto --maxprocesses 4 tests/docs

FUZZ := 5000
fuzz: $(VENV)/tested
	SCARID_FUZZ=$(FUZZ) $(TESTING) $(BIN)/python -m pytest -n auto --maxprocesses 4 tests/fuzz

$(VENV)/mutable: $(VENV)/tested
	$(PIP) install --editable '.[mutants]'
	@touch $@

mutants: $(VENV)/mutable  # goes on where it was stopped; after changes: rm -r build/mutants
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python benchmarks/mutants.py

faults: $(VENV)/tested  # the page is replaced only by a whole one
	@mkdir -p build
	$(TESTING) $(BIN)/python tests/faults/campaign.py > build/faults.md; \
	  status=$$?; test -s build/faults.md && mv build/faults.md docs/faults.md; exit $$status

lint: $(VENV)/tested
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

$(VENV)/compared: $(VENV)/tested
	$(PIP) install --editable '.[compare]'
	@touch $@

bench: $(VENV)/compared
	$(BIN)/python benchmarks/bench.py

bench-identify: $(VENV)/tested
	OMP_NUM_THREADS=1 $(BIN)/python benchmarks/identify_steps.py

bench-latency: $(VENV)/tested
	$(BIN)/python benchmarks/latency.py 200
	$(BIN)/python benchmarks/latency.py 1000

# The headers of Eigen, which Pinocchio's C++ needs, in a folder of their own.
EIGEN := build/eigen/cmeel.prefix/include/eigen3

$(EIGEN): | $(VENV)/tested
	$(PIP) install --no-deps --target build/eigen cmeel-eigen

bench-arms: $(VENV)/tested
	$(BIN)/python benchmarks/random_arms.py --arms 25

bench-exported: $(VENV)/tested $(EIGEN)
	$(BIN)/python benchmarks/exported.py --eigen $(EIGEN)

bench-excitation: $(VENV)/tested
	$(BIN)/python benchmarks/excitation.py
	$(BIN)/python benchmarks/excitation.py --seconds 10
	$(BIN)/python benchmarks/excitation.py --seconds 120 --seeds 1

bench-experiments: $(VENV)/tested
	$(BIN)/python benchmarks/experiments.py
	$(BIN)/python benchmarks/arms.py
	$(BIN)/python benchmarks/sequences.py --planning "--starts 2 --criterion d --set interval=0.8"
	$(BIN)/python benchmarks/sequences.py --robot samples/robots/ur10e.toml \
	  --home 0,-1.5708,0,-1.5708,0,0 --planning "--starts 1 --criterion d"

bench-differentiators: $(VENV)/compared
	$(BIN)/python benchmarks/differentiators.py

crossvalidate: $(VENV)/tested
	$(BIN)/python benchmarks/crossvalidation.py

montecarlo: $(VENV)/tested
	$(BIN)/python benchmarks/montecarlo.py

bench-verdicts: $(VENV)/tested
	$(BIN)/python benchmarks/verdicts.py

gauntlet: $(VENV)/tested
	OMP_NUM_THREADS=1 $(BIN)/python benchmarks/gauntlet.py

bench-mixtures: $(VENV)/tested
	OMP_NUM_THREADS=1 $(BIN)/python benchmarks/mixtures.py

bench-carried: $(VENV)/tested
	OMP_NUM_THREADS=1 $(BIN)/python benchmarks/carried.py

bench-known-load: $(VENV)/tested
	cd benchmarks && ../$(BIN)/python known_load.py
	cd benchmarks && ../$(BIN)/python known_load.py --free

bench-payloads: $(VENV)/tested
	OMP_NUM_THREADS=1 $(BIN)/python benchmarks/payloads.py --runs 66

bench-aims: $(VENV)/tested
	$(BIN)/python benchmarks/aims.py --seeds 6

bench-loop: $(VENV)/tested
	cd benchmarks && ../$(BIN)/python in_the_loop.py

bench-coarse: $(VENV)/tested
	cd benchmarks && ../$(BIN)/python coarse.py

bench-tilts: $(VENV)/tested
	$(TESTING) $(BIN)/python benchmarks/tilts.py

bench-gains: $(VENV)/tested
	$(BIN)/python benchmarks/gains.py

bench-forgetting: $(VENV)/tested
	$(BIN)/python benchmarks/forgetting.py

bench-friction: $(VENV)/tested
	$(BIN)/python benchmarks/friction.py

bench-contacts: $(VENV)/tested
	$(BIN)/python benchmarks/contacts.py

bench-mujoco: $(VENV)/tested
	OMP_NUM_THREADS=1 $(BIN)/python benchmarks/mujoco_arms.py --seeds 10

bench-checks: $(VENV)/tested
	$(BIN)/python benchmarks/checks.py
	OMP_NUM_THREADS=1 $(BIN)/python benchmarks/checks_kinds.py

bench-within: $(VENV)/tested
	OMP_NUM_THREADS=1 $(BIN)/python benchmarks/within.py --seeds 3 --seed 70000

bench-changed: $(VENV)/tested
	OMP_NUM_THREADS=1 $(BIN)/python benchmarks/changed.py

EMPS ?= ../shared/data/emps/emps_train.csv
emps: $(VENV)/tested
	$(BIN)/python benchmarks/emps.py $(EMPS)

# --- batches ------------------------------------------------------------------------------------

BATCH   := .venv-batch
PROFILE ?= local

$(BATCH)/installed: $(BUILD_FILES)
	@echo 'batch: making the environment $(BATCH) for Snakemake, once; this takes two minutes' >&2
	@test -x $(BATCH)/bin/python || $(PYTHON) -m venv $(BATCH)
	@$(BATCH)/bin/python -m pip --disable-pip-version-check --quiet install --editable '.[batch,logs,urdf]'
	@touch $@

$(BATCH)/tested: $(BATCH)/installed
	$(BATCH)/bin/python -m pip --disable-pip-version-check --quiet install pytest pytest-xdist hypothesis
	@touch $@

batch: $(BATCH)/installed
	@test -n "$(CONFIG)" || { echo "make batch CONFIG=FILE: which configuration? See docs/batch.md"; exit 2; }
	@$(BATCH)/bin/python workflow/batch.py $(CONFIG) --profile $(PROFILE) $(OPTIONS)

test-batch: $(BATCH)/tested
	$(BATCH)/bin/python -m pytest tests/workflows

test-slurm: $(BATCH)/tested
	$(BATCH)/bin/python -m pytest tests/slurm

LOGS ?= 1000
bench-batch: $(VENV)/installed $(BATCH)/installed
	$(BIN)/python benchmarks/batch.py $(LOGS) $(PARTS)

docs: $(VENV)/installed
	$(BIN)/python -m scarid_cli.reporting.schemas > docs/tables.md
	$(BIN)/python -m scarid_cli.reporting.beyond > docs/beyond.md

FIGURES :=
figures: $(VENV)/installed
	cd docs && $(TESTING) ../$(BIN)/python -m figures $(FIGURES)

# Not the package, only what the site needs: its pages are made of declarations, without kernels.
SITE := .venv-site

$(SITE)/installed: pyproject.toml
	@test -x $(SITE)/bin/python || $(PYTHON) -m venv $(SITE)
	@$(SITE)/bin/python -c 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["project"]["optional-dependencies"]["site"], sep="\n")' > $(SITE)/requirements.txt
	@$(SITE)/bin/python -m pip --disable-pip-version-check --quiet install --requirement $(SITE)/requirements.txt
	@touch $@

# The variable hides what the theme says of other programs than this site.
site: $(SITE)/installed
	@NO_MKDOCS_2_WARNING=1 $(SITE)/bin/mkdocs build --quiet --strict
	@echo 'build/site/index.html'

man: $(VENV)/installed
	$(BIN)/python -m scarid_cli.cli.manual build/man

$(VENV)/packaging: pyproject.toml | $(BIN)/python
	$(PIP) install 'abi3audit>=0.0.26' 'build>=1.2'
	@touch $@

wheel: $(VENV)/packaging  # made of the source distribution, so that one lacks nothing
	rm -rf build/dist
	$(BIN)/python -m build --outdir build/dist .
	@for wheel in build/dist/*abi3*.whl; do \
	  if [ -e "$$wheel" ]; then $(BIN)/abi3audit --strict --summary "$$wheel"; fi; done

minute: wheel
	@sh packaging/first_minute.sh $(PYTHON) build/minute

clean:
	rm -rf build $(VENV) .venv-batch $(SITE) *.egg-info .hypothesis .pytest_cache .mypy_cache .ruff_cache
	rm -f scarid_cli/kernels/*.so

# --- the paper's procedure ------------------------------------------------------------------------
#
# METHOD.direct.* is validated on the trajectory of the identification, METHOD.cross.* on another one.
# METHOD.common.* uses the other trajectory too, but one zero-phase filtered motion for all methods.

P := build/paper

PRINTED := ed-fir 2smd astd p2smd
OWN     := p2smd-matched kalman 2smd-mended astd-mended
ONLINE  := $(PRINTED) $(OWN)
METHODS := $(ONLINE) kalman-wls
# Recursive least squares as in the paper: all rows, and all joints alike.
PAPERS  := --estimator rls --set weights=0 --all-rows

# As in the paper: the log is filtered, the settings are those of Table 1, and torques are not matched.
OPTIONS_ed-fir := --method ed-fir --preset table1 --no-match
OPTIONS_2smd   := --method 2smd --preset table1 --no-match
OPTIONS_astd   := --method astd --preset table1 --no-match
OPTIONS_p2smd  := --method p2smd --preset table1 --no-match
# The same, with gains that can follow the motion.
OPTIONS_2smd-mended := --method 2smd --no-match
OPTIONS_astd-mended := --method astd --no-match
# Our methods: the log is not filtered before the soft sensor, and torques are matched.
OPTIONS_p2smd-matched := --method p2smd --preset table1 --match
OPTIONS_kalman        := --method kalman --match
OPTIONS_kalman-wls    := --method kalman --match
LOG_p2smd-matched := raw
LOG_kalman        := raw
LOG_kalman-wls    := raw
log_of = $(P)/$(or $(LOG_$1),filtered).$2.measurement.parquet

SEED_direct := 1
SEED_cross  := 2
SEED_optimised := 1
SEED_printed-gains := 1
GAINS_printed-gains := --kp 6.5,155 --kd 5,25

MEASURED := $(P)/raw.direct.measurement.parquet $(P)/filtered.direct.measurement.parquet \
              $(P)/raw.printed-gains.measurement.parquet
RESULTS  := $(foreach m,$(METHODS),$(P)/$m.parameters.parquet \
              $(foreach e,direct cross,$(P)/$m.$e.metrics.parquet $(P)/$m.$e.prediction.parquet) \
              $(P)/$m.common.metrics.parquet) \
            $(foreach m,$(ONLINE),$(P)/$m.direct.motion.parquet $(P)/$m.trace.parquet \
              $(P)/$m.forgetting-0.95.parameters.parquet) \
            $(P)/kalman-wls-optimised.parameters.parquet

paper: $(P)/report.html

$(P)/report.html: $(RESULTS) $(MEASURED) samples/paper/published.csv
	$(SCARID) report $(RESULTS) $(MEASURED) --published samples/paper/published.csv \
	  --html $@ --markdown $(P)/report.md --figures $(P)/figures --title "The paper's study"
	@echo; echo "With figures: $@"

$(P)/%.trajectory.parquet: $(VENV)/installed
	@mkdir -p $(P)
	$(SCARID) trajgen --robot scara2 --seed $(SEED_$*) -o $@

# The number of starts, and not a budget of time: the same motion each time.
$(P)/optimised.trajectory.parquet: $(VENV)/installed
	@mkdir -p $(P)
	$(SCARID) trajgen --robot scara2 --optimise --starts 4 --seed $(SEED_optimised) -o $@

$(P)/raw.%.measurement.parquet: $(P)/%.trajectory.parquet
	$(SCARID) simulate --seed $(SEED_$*) --truth $(GAINS_$*) $< -o $@

$(P)/filtered.%.measurement.parquet: $(P)/raw.%.measurement.parquet
	$(SCARID) filter --natural-frequency 2 $< -o $@

$(P)/common.motion.parquet: $(P)/raw.cross.measurement.parquet
	$(SCARID) differentiate --method zero-phase --set cutoff=8 --match $< -o $@

.SECONDEXPANSION:

define MOTION
$(P)/%.$1.motion.parquet: $$$$(call log_of,$$$$*,$1)
	$(SCARID) differentiate $$(OPTIONS_$$*) $$< -o $$@
endef
$(foreach e,direct cross optimised,$(eval $(call MOTION,$e)))

$(P)/%.parameters.parquet $(P)/%.trace.parquet: $(P)/%.direct.motion.parquet
	$(SCARID) identify $(PAPERS) --trace $(P)/$*.trace.parquet $< -o $(P)/$*.parameters.parquet

# Joints are weighted, slow rows are left out, and the delay of the torques is fitted. Rows near
# reversals remain, as in every other procedure of this study.
$(P)/kalman-wls.parameters.parquet: $(P)/kalman.direct.motion.parquet
$(P)/kalman-wls-optimised.parameters.parquet: $(P)/kalman.optimised.motion.parquet
$(P)/kalman-wls.parameters.parquet $(P)/kalman-wls-optimised.parameters.parquet:
	$(SCARID) identify --estimator wls --all-rows --drop-slow 0.1 --align $< -o $@

$(P)/%.forgetting-0.95.parameters.parquet: $(P)/%.direct.motion.parquet
	$(SCARID) identify $(PAPERS) --forgetting 0.95 $< -o $@

define VALIDATE
$(P)/%.$1.metrics.parquet $(P)/%.$1.prediction.parquet: $(P)/%.$1.motion.parquet $(P)/%.parameters.parquet
	$(SCARID) validate --all-rows --parameters $(P)/$$*.parameters.parquet \
	  --predictions $(P)/$$*.$1.prediction.parquet $$< -o $(P)/$$*.$1.metrics.parquet
endef
$(foreach e,direct cross,$(eval $(call VALIDATE,$e)))

$(P)/%.common.metrics.parquet: $(P)/common.motion.parquet $(P)/%.parameters.parquet
	$(SCARID) validate --all-rows --parameters $(P)/$*.parameters.parquet $< -o $@

# --- the same over many seeds -----------------------------------------------------------------------

SEEDS := 50
M     := build/montecarlo
OF    := parameters direct.metrics cross.metrics common.metrics
of    = $(foreach m,$(METHODS),$(OF:%=$1/$m.%.parquet)) $(foreach m,$(ONLINE),$1/$m.trace.parquet)

paper-montecarlo: $(M)/report.html

$(M)/report.html: $(foreach s,$(shell seq $(SEEDS)),$(M)/$s/done) samples/paper/published.csv
	ulimit -n 16384; $(SCARID) report --repeated --published samples/paper/published.csv \
	  $(foreach s,$(shell seq $(SEEDS)),$(call of,$(M)/$s)) \
	  --html $@ --markdown $(M)/report.md --title "The paper's study over $(SEEDS) seeds"

# The seeds are 2 s + 1 and 2 s + 2, as in `make crossvalidate`; `make paper` uses others.
$(M)/%/done: $(VENV)/installed
	@mkdir -p $(@D)
	$(MAKE) --silent P=$(@D) SEED_direct=$$((2 * $* + 1)) SEED_cross=$$((2 * $* + 2)) repetition
	@rm -f $(@D)/*.motion.parquet $(@D)/*.measurement.parquet $(@D)/*.prediction.parquet
	@touch $@

repetition: $(call of,$(P))

# Keep all intermediate tables, so that `scarid info` and `scarid convert` can show them.
.SECONDARY:

# --- samples --------------------------------------------------------------------------------------

samples: $(VENV)/installed
	$(SCARID) trajgen --seed 1 --duration 5 --rate 100 --format arrow | \
	  $(SCARID) simulate --seed 1 --log-rate 100 --format arrow | \
	  $(SCARID) convert -o samples/scara2.csv
	$(SCARID) filter --zero-phase --cutoff 8 samples/scara2.csv | \
	  $(SCARID) differentiate --method central | \
	  $(SCARID) identify --estimator ls --all-rows -o samples/scara2.parameters.csv
