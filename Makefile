# Needs only Python 3.11 or newer and make. Everything lives in .venv.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
RUN ?= friction-run
LARGEST ?= 1e8

# three processes on two cores: some tests wait for schedulers, kills and time limits;
# a module's tests in one process, which makes their fixtures once
SHARED := -n 3 --dist loadscope --no-loadscope-reorder

# tests and studies share the cores out among processes: one thread of linear algebra each
export OMP_NUM_THREADS := 1
export OPENBLAS_NUM_THREADS := 1

.PHONY: docs/epsilon.png reproduce test test-all test-long lint docs dist same coverage blind unnamed comparison fleet planning wear real real-diagnoses bench fuzz fuzz-c kill soak memory clean

reproduce: $(VENV)/installed
	$(BIN)/frictioncli run sample_logs/kr10 -w $(RUN)
	$(BIN)/python docs/compare_with_paper.py $(RUN)

# the figure of the README and of the site, from the sample logs
docs/epsilon.png: $(VENV)/installed
	$(BIN)/frictioncli run sample_logs/kr10 -w $(RUN)
	$(BIN)/frictioncli report -w $(RUN) --png
	cp $(RUN)/report/fig11.png $@

test: $(VENV)/tested
	$(BIN)/pytest $(SHARED) -m "not slow and not long"

test-all: $(VENV)/tested
	$(BIN)/pytest $(SHARED) -m "not long" --durations 40

test-long: $(VENV)/tested
	$(BIN)/pytest $(SHARED) -m long

coverage: $(VENV)/tested
	$(BIN)/python -m tests.studies.coverage

blind: $(VENV)/tested
	$(BIN)/python -m tests.studies.blind --jobs 2 --write

unnamed: $(VENV)/tested
	$(BIN)/python -m tests.studies.unnamed --jobs 2 --write

comparison: $(VENV)/studied
	$(BIN)/python -m tests.studies.comparison

fleet: $(VENV)/tested
	$(BIN)/python -m tests.studies.fleet

planning: $(VENV)/tested
	$(BIN)/python -m tests.studies.planning

wear: $(VENV)/tested
	$(BIN)/python -m tests.studies.wear 20

real: $(VENV)/tested
	$(BIN)/python -m tests.studies.real $(REAL)

real-diagnoses: $(VENV)/tested
	$(BIN)/python -m tests.studies.real_diagnoses $(REAL)

bench: $(VENV)/studied
	$(BIN)/python -m tests.studies.minimum
	$(BIN)/python -m tests.studies.bench_growth --largest $(LARGEST)
	$(BIN)/python -m tests.studies.bench

fuzz: $(VENV)/tested
	$(BIN)/python -m tests.studies.fuzz $(FUZZ)

fuzz-c: $(VENV)/tested
	$(BIN)/python -m tests.studies.fuzz_c $(FUZZ)

kill: $(VENV)/tested
	$(BIN)/python -m tests.studies.kill

soak: $(VENV)/tested
	$(BIN)/python -m tests.studies.soak $(SOAK)

memory: $(VENV)/tested
	$(BIN)/python -m tests.studies.memory $(MEMORY)

same: $(VENV)/tested
	$(BIN)/python -m tests.studies.same

lint: $(VENV)/tested
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# site/index.html; strict: a broken link or docstring fails
docs: $(VENV)/documented
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

# dist/*.tar.gz and dist/*.whl
dist: $(VENV)/tested
	rm -rf dist
	$(BIN)/python -m build

# by all cores, where pip uses one; this package too, whose bytecode no process writes where
# PYTHONDONTWRITEBYTECODE is set
COMPILE := $(BIN)/python -m compileall -qq -j 0 $(VENV)/lib frictioncli || true

$(VENV)/installed: pyproject.toml frictioncli/logs/formats/_plain_numbers.c
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check --editable .
	$(COMPILE)
	touch $@

# one installation for both: each builds the C extensions anew
$(VENV)/tested: pyproject.toml frictioncli/logs/formats/_plain_numbers.c
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check --editable '.[dev]'
	$(COMPILE)
	touch $(VENV)/installed $@

$(VENV)/documented: $(VENV)/installed
	$(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check --editable '.[docs]'
	$(COMPILE)
	touch $@

$(VENV)/studied: $(VENV)/tested
	$(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check --editable '.[dev,study]'
	$(COMPILE)
	touch $@

clean:
	rm -rf $(VENV) $(RUN) site dist build
