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

# The stamp changes when the dependencies do, so that an old environment is brought up to date.
$(VENV)/.installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[$(EXTRAS)]'
	@touch $@

$(VENV)/.docs: $(VENV)/.installed
	$(BIN)/pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[docs]'
	@touch $@

demo: $(VENV)/.installed ## Find an object in a generated house; pictures in runs/demo
	$(BIN)/toponav demo --out runs/demo

test: $(VENV)/.installed ## Run the tests
	$(BIN)/pytest --numprocesses 2 --dist loadfile

check: $(VENV)/.installed ## Lint, formatting and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

docs: $(VENV)/.docs ## Build the documentation into build/site; a dead link is an error
	$(BIN)/mkdocs build --strict --quiet

figures: $(VENV)/.installed ## Draw the pictures of the documentation anew
	$(BIN)/python docs/make_vocabulary_page.py
	$(BIN)/python docs/make_furniture_sheet.py
	$(BIN)/python docs/make_demo_picture.py
	$(BIN)/python docs/make_concept_figures.py

bench: $(VENV)/.installed ## Print the performance figures
	$(BIN)/toponav bench sim

clean: ## Remove the environment and all caches
	rm -rf $(VENV) build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
