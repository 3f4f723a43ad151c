# One command a chore, the same here and in CI. Needs python3 (3.11 or later), make and git; the rest is set up in .venv.

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
PYTEST := $(BIN)/python -m pytest
# Two workers on two cores take little more than half the time; tests that time nothing allow it. Each begins with a part of
# its own, so that what a file's tests share is made by one of them.
PARALLEL ?= --numprocesses auto --dist worksteal

# Tests start hundreds of processes, each of which would compile every module anew where this is set.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help demo test test-compiled test-plain test-fast test-exhaustive test-qgis test-qgis-numpy2 matrix coverage lint check docs plugin release clean

help:
	@echo "make demo       a real DEM to a wavelet pyramid, a table and a picture, in demo_output/"
	@echo "make test       all tests: the three parts below, each whatever the others came to"
	@echo "make test-compiled  the tests of core, files and command line, kernels compiled by numba"
	@echo "make test-plain  the core's small tests again, without numba: on whole arrays"
	@echo "make test-fast  the core's small tests only, compiled"
	@echo "make test-exhaustive  every case of what make test has a sample of, also part of make check"
	@echo "make test-qgis  the plugin's tests in QGIS, which is installed on Debian as root if it is missing"
	@echo "make test-qgis-numpy2  the same in a second QGIS with Python 3.13 and numpy 2, in a chroot"
	@echo "make matrix     those of test-compiled on the installed wheel: each Python on PATH, oldest and newest packages"
	@echo "make coverage   which lines and branches those tests reach, but for QGIS's"
	@echo "make lint       ruff, mypy and numpydoc"
	@echo "make docs       the documentation as a site, in docs/_build/html"
	@echo "make plugin     the QGIS plugin as dist/terrain_wavelets.zip, from the last commit"
	@echo "make check      lint, test and docs"
	@echo "make release    wheel, source, plugin, manual page and completions in dist/, once all is ready"
	@echo "make clean      remove what the above made, except $(VENV)"

# The environment alone: enough for what needs pip and nothing of ours.
$(BIN)/python:
	@bash scripts/setup-venv.sh $(VENV) $(PYTHON)

# A stamp for each set of packages, so that a second run starts at once.
$(BIN)/.installed-%: pyproject.toml scripts/setup-venv.sh
	@bash scripts/setup-venv.sh $(VENV) $(PYTHON) $*
	@touch $@

demo: $(BIN)/.installed-demo
	@$(BIN)/python examples/demo.py demo_output

# A part that fails does not hide the others: with --keep-going all run, and all are told of.
test:
	@$(MAKE) --no-print-directory --keep-going test-compiled test-plain test-qgis

# The plugin under Qt 6 needs PyQt6 and no QGIS, so it is among these.
COMPILED := --ignore tests/plugin/algorithms --ignore tests/plugin/dialogs --ignore-glob '*/test_qgis_*' --ignore tests/models -m "not exhaustive"
PLAIN := tests/core -m "not large and not data"

test-compiled: $(BIN)/.installed-dev
	$(PYTEST) $(COMPILED) $(PARALLEL)

test-plain: $(BIN)/.installed-dev
	TERRAIN_WAVELETS_NO_NUMBA=1 $(PYTEST) $(PLAIN) $(PARALLEL)

# A test that fails here alone (one of a full disk, say) takes nothing from what the others reach.
coverage: $(BIN)/.installed-dev
	$(BIN)/python -m coverage erase
	-$(BIN)/python -m coverage run -m pytest $(COMPILED) $(PARALLEL)
	-TERRAIN_WAVELETS_NO_NUMBA=1 $(BIN)/python -m coverage run -m pytest $(PLAIN) $(PARALLEL)
	$(BIN)/python -m coverage combine --quiet
	$(BIN)/python -m coverage report

test-fast: $(BIN)/.installed-dev
	$(PYTEST) tests/core tests/test_imports.py -m "not large and not data" -x -q

test-exhaustive: $(BIN)/.installed-dev
	$(PYTEST) tests/gis -m exhaustive $(PARALLEL)

# Under CI these fail where they cannot run; elsewhere they say so in one line.
test-qgis:
	@bash scripts/qgis-test.sh

test-qgis-numpy2:
	@bash scripts/qgis-test.sh --chroot

# Other Pythons, and other tests: make matrix PYTHONS="python3.12 /opt/python/bin/python3" TESTS="tests/gis -x"
matrix:
	@$(PYTHON) scripts/matrix.py $(PYTHONS) -- $(TESTS)

# The plugin is checked against stubs of QGIS, so that this needs no QGIS.
lint: $(BIN)/.installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/python -m numpydoc.hooks.validate_docstrings $$(git ls-files 'wavelet_core/*.py' 'wavelet_gis/*.py')

# The site, readable offline, in docs/_build/html. Whatever Sphinx warns of is an error.
docs: $(BIN)/.installed-docs
	$(BIN)/python -m sphinx --fail-on-warning --keep-going -q -b html docs docs/_build/html
	@echo docs/_build/html/index.html

plugin: | $(BIN)/python
	@$(BIN)/python scripts/plugin_zip.py

check: lint test test-exhaustive docs

# Files for a release in dist/; says what only a person can fill in. make release DRAFT=--draft makes them all the same.
release: $(BIN)/.installed-release
	@$(BIN)/python scripts/release.py $(DRAFT)

clean:
	rm -rf build dist demo_output docs/_build docs/made docs/_static/levels.html *.egg-info .pytest_cache .hypothesis .ruff_cache .mypy_cache
	find . -name __pycache__ -not -path './$(VENV)/*' -prune -exec rm -rf {} +
