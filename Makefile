# Needs only Python 3.11 or newer and make. Everything lives in .venv.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
RUN ?= friction-run

.PHONY: reproduce test lint coverage blind comparison clean

reproduce: $(VENV)/installed
	$(BIN)/frictioncli run sample_logs/kr10 -w $(RUN)
	$(BIN)/python docs/compare_with_paper.py $(RUN)

test: $(VENV)/tested
	$(BIN)/pytest -n 2

coverage: $(VENV)/tested
	$(BIN)/python -m tests.studies.coverage

blind: $(VENV)/tested
	OMP_NUM_THREADS=1 $(BIN)/python -m tests.studies.blind

comparison: $(VENV)/studied
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python -m tests.studies.comparison

lint: $(VENV)/tested
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

$(VENV)/installed: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	touch $@

$(VENV)/tested: $(VENV)/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	touch $@

$(VENV)/studied: $(VENV)/tested
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev,study]'
	touch $@

clean:
	rm -rf $(VENV) $(RUN)
