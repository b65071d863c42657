# Two targets do everything: `make run` and `make test`. Both set up what they need.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
WORKERS ?= auto
SHARED_OUT := -n $(WORKERS) --dist loadfile --no-loadscope-reorder
MODULE ?=
SAMPLE ?=

.PHONY: run test slow install install-test lint types layers unit coverage notebooks mutate hooks clean help

help:  ## list the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*##/\t/' | expand -t 16

run: install  ## set up, then run scenario pouring
	$(BIN)/drake-screw run pouring

test: install-test lint types layers unit notebooks  ## set up, then lint, check types and layers, run all tests and notebooks

install: $(VENV)/.installed

install-test: $(VENV)/.installed-test

$(VENV)/bin/python:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed")'
	$(PYTHON) -m venv $(VENV)

$(VENV)/.installed: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	touch $@

$(VENV)/.installed-test: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test]'
	touch $@ $(VENV)/.installed

$(VENV)/.installed-development: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test,development]'
	touch $@ $(VENV)/.installed $(VENV)/.installed-test

lint: install-test  ## ruff
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: install-test  ## mypy
	$(BIN)/mypy

layers: install-test  ## import-linter: data flows one way
	$(BIN)/lint-imports

unit: install-test  ## pytest; a file's tests share what they set up, so one process runs them
	$(BIN)/pytest $(SHARED_OUT)

coverage: install-test  ## pytest, and which lines it ran; a good deal slower
	$(BIN)/coverage erase
	$(BIN)/pytest $(SHARED_OUT) --cov=drake_screw --cov-report=term

slow: install-test  ## the long trials that `make test` leaves out
	$(BIN)/pytest -n $(WORKERS) --dist worksteal -m slow

notebooks: install-test  ## run the tutorials
	$(BIN)/pytest --nbmake --nbmake-timeout=300 -n $(WORKERS) tutorials

mutate: $(VENV)/.installed-development  ## mutation testing; MODULE=drake_screw/screws/poses.py, SAMPLE=40 mutants at random
	nice $(BIN)/python benchmarks/mutation.py $(MODULE) $(if $(SAMPLE),--sample $(SAMPLE))

hooks: $(VENV)/.installed-development  ## run the checks before every commit
	$(BIN)/pre-commit install

clean:  ## remove everything that was built
	rm -rf $(VENV) build dist .coverage* .mypy_cache .pytest_cache .ruff_cache .hypothesis
