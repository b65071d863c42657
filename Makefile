# Two targets do everything: `make run` and `make test`. Both set up what they need.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
WORKERS ?= auto
SHARED_OUT := -n $(WORKERS) --dist loadfile --no-loadscope-reorder
MODULE ?=
SAMPLE ?=
SITE = -c docs/site -d build/doctrees -j auto .

.PHONY: run test slow install install-test lint types layers unit coverage docs linkcheck notebooks mutate hooks clean help

help:  ## list the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*##/\t/' | expand -t 16

run: install  ## set up, then run scenario pouring
	$(BIN)/drake-screw run pouring

test: install-test lint types layers unit docs  ## set up, then lint, check types and layers, run all tests and tutorials, build the site

install: $(VENV)/.installed

install-test: $(VENV)/.installed-test

$(VENV)/bin/python:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed")'
	$(PYTHON) -m venv $(VENV)

$(VENV)/.installed: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	touch $@

$(VENV)/.installed-test: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test,docs]'
	touch $@ $(VENV)/.installed

$(VENV)/.installed-development: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test,docs,development]'
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

docs: install-test  ## run the tutorials and build the documentation site, build/site; any warning or dead link fails
	$(BIN)/python docs/site/execute.py
	rm -rf build/site
	$(BIN)/sphinx-build -b html -W --keep-going --quiet $(SITE) build/site
	$(BIN)/python docs/site/check_links.py build/site

linkcheck: install-test  ## ask for the addresses of other sites that the documentation links to
	$(BIN)/python docs/site/execute.py
	$(BIN)/sphinx-build -b linkcheck $(SITE) build/linkcheck

notebooks: install-test  ## run the tutorials alone
	$(BIN)/pytest --nbmake --nbmake-timeout=300 -n $(WORKERS) tutorials

mutate: $(VENV)/.installed-development  ## mutation testing; MODULE=drake_screw/screws/poses.py, SAMPLE=40 mutants at random
	nice $(BIN)/python benchmarks/mutation.py $(MODULE) $(if $(SAMPLE),--sample $(SAMPLE))

hooks: $(VENV)/.installed-development  ## run the checks before every commit
	$(BIN)/pre-commit install

clean:  ## remove everything that was built
	rm -rf $(VENV) build dist .coverage* .mypy_cache .pytest_cache .ruff_cache .hypothesis
