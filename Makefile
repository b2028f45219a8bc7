# Two commands on a fresh machine (Python 3.11 or newer, make): `make demo` and `make test`.
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
# Extras beside dev; tests of the others skip.
EXTRAS ?= dev,ray,onnx,viz,gl,ros2,bags

.DEFAULT_GOAL := help
.PHONY: help demo test check docs figures bench clean

help: ## List the targets
	@grep -E '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/'

PIP := $(BIN)/pip install --quiet --disable-pip-version-check --constraint constraints.txt

# The stamps change when the dependencies do, so that an old environment is brought up to date.
# The demo needs the package alone, which is there in a fraction of the time of the extras.
$(VENV)/.package: pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(not (3, 11) <= sys.version_info < (3, 14))' || \
	  { echo "TopoNav needs Python 3.11 to 3.13: say which, as in make demo PYTHON=python3.12" >&2; exit 2; }
	@echo "installing into $(VENV)" >&2
	@$(PYTHON) -m venv $(VENV)
	@$(PIP) --editable .
	@touch $@

$(VENV)/.installed: $(VENV)/.package
	@echo "installing the extras $(EXTRAS) into $(VENV)" >&2
	@$(PIP) --editable '.[$(EXTRAS)]'
	@touch $@

$(VENV)/.docs: $(VENV)/.package
	@$(PIP) --editable '.[docs]'
	@touch $@

demo: $(VENV)/.package ## Find an object in a generated house; pictures in runs/demo
	$(BIN)/toponav demo --out runs/demo

test: $(VENV)/.installed ## Run the tests
	$(BIN)/pytest --numprocesses 2 --dist loadfile

check: $(VENV)/.installed ## Lint, formatting and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

docs: $(VENV)/.docs ## Build the documentation into build/site; a dead link is an error
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet
	@echo "built: open build/site/index.html, or, to search too: $(PYTHON) -m http.server -d build/site" >&2

figures: $(VENV)/.installed ## Draw the pictures of the documentation anew
	$(BIN)/python docs/make_vocabulary_page.py
	$(BIN)/python docs/make_furniture_sheet.py
	$(BIN)/python docs/make_demo_picture.py
	$(BIN)/python docs/make_concept_figures.py

bench: $(VENV)/.installed ## Print the performance figures
	$(BIN)/toponav bench sim

clean: ## Remove the environment and all caches
	rm -rf $(VENV) build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
