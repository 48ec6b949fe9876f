# Each target sets up its own .venv from nothing; a target whose inputs have not changed since it last passed does nothing.
PYTHON ?= python3
STAMPS := .venv/stamps
CODE := $(shell find rocking_cli -name '*.py')
CONFIGS := $(shell find configs -type f)
TESTS := $(shell find tests -type f -not -path '*/__pycache__/*')

.PHONY: demo test lint bench soak clean

demo: out/demo.h5
test: $(STAMPS)/test
lint: $(STAMPS)/lint

$(STAMPS)/install: pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed: make PYTHON=...")'
	$(PYTHON) -m venv .venv
	.venv/bin/python -m pip install --quiet --disable-pip-version-check --editable .
	mkdir -p $(STAMPS) && touch $@

$(STAMPS)/dev: $(STAMPS)/install
	.venv/bin/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	touch $@

out/demo.h5: $(STAMPS)/install $(CODE) $(CONFIGS)
	mkdir -p out
	.venv/bin/rocking params configs/block.yaml configs/spire.yaml
	.venv/bin/rocking spectrum configs/block.yaml configs/spire.yaml --grid a_g=0.1g:1.2g:200,f_g=0.2:5:200 --overwrite -o $@
	.venv/bin/rocking envelope configs/block.yaml --grid f_g=0.5:2:4

$(STAMPS)/test: $(STAMPS)/dev $(CODE) $(CONFIGS) $(TESTS) README.md
	.venv/bin/python -m pytest
	touch $@

$(STAMPS)/lint: $(STAMPS)/dev $(CODE) $(TESTS)
	.venv/bin/ruff format --check .
	.venv/bin/ruff check .
	.venv/bin/mypy
	touch $@

bench: $(STAMPS)/dev
	.venv/bin/python -m pip install --quiet --disable-pip-version-check --editable '.[bench]'
	.venv/bin/python tests/bench/bench.py

soak: $(STAMPS)/dev
	.venv/bin/python -m pytest -m soak

clean:
	rm -rf .venv out dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
