# Only make and Python >= 3.11 are needed; everything else goes into .venv, once.
#   make demo   the bi-material bar by every method, against finite elements; then says where the results are
#   make test   all tests
#   make lint   style, types and the direction of imports
#   make clean  removes .venv and results
# PYTHON=python3.12 make demo   takes another Python; PYTEST_ARGS="-k bar" goes to pytest.

PYTHON ?= python3
PYTEST_ARGS ?=
OUT ?= results/bimaterial-bar

VENV := .venv
BIN := $(VENV)/bin
BASE := $(VENV)/.stamp-venv
RUN := $(VENV)/.stamp-run
TEST := $(VENV)/.stamp-test

.PHONY: demo test lint clean

demo: $(RUN)
	$(BIN)/matpoint verify bimaterial-bar --out $(OUT) --force
	@echo
	@echo "The paper's figures 3, 4 and 5, by every method, are in $(CURDIR)/$(OUT):"
	@ls $(OUT)/*.png
	@echo "Results:"
	@ls $(OUT)/* | grep -v '\.png$$'

test: $(TEST)
	$(BIN)/python -m pytest $(PYTEST_ARGS)

lint: $(TEST)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright
	$(BIN)/lint-imports

clean:
	rm -rf $(VENV) results .pytest_cache .ruff_cache .hypothesis .import_linter_cache

$(BASE):
	@command -v $(PYTHON) >/dev/null || { echo "error: '$(PYTHON)' is not installed; install Python >= 3.11, or name one: make $(MAKECMDGOALS) PYTHON=/path/to/python3"; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "error: matpoint needs Python >= 3.11; '$(PYTHON)' is $$($(PYTHON) --version 2>&1). Name a newer one: make $(MAKECMDGOALS) PYTHON=python3.12"; exit 1; }
	@$(PYTHON) -m venv $(VENV) || { echo "error: '$(PYTHON) -m venv' failed; on Debian or Ubuntu install the package python3-venv"; exit 1; }
	@touch $@

$(RUN): pyproject.toml $(BASE)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	@touch $@

$(TEST): pyproject.toml $(BASE)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[test]"
	@touch $(RUN) $@
