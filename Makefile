# Each target sets up its own .venv from nothing; a target whose inputs have not changed since it last passed does nothing.
PYTHON ?= python3
STAMPS := .venv/stamps
CODE := $(shell find rocking_cli -type f -not -path '*/__pycache__/*')
CONFIGS := $(shell find configs -type f)
TESTS := $(shell find tests -type f -not -path '*/__pycache__/*')

.PHONY: help demo test lint quick docs figures study code-study bench database golden trace soak ladder mutants readers clean

.DEFAULT_GOAL := help
# Two processes of tests have two cores: threads of OpenBLAS would wait for each other.
quick $(STAMPS)/test: export OPENBLAS_NUM_THREADS = 1
# The tests keep their compiled modules, whose assertions take seconds to rewrite.
quick $(STAMPS)/test: export PYTHONDONTWRITEBYTECODE =

help: ## This list
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  \1\t\2/p' $(MAKEFILE_LIST) | expand -t 14

demo: out/demo.h5 ## Set up .venv and compute a first spectrum, out/demo.h5
test: $(STAMPS)/test ## Set up .venv and run the tests
lint: $(STAMPS)/lint ## Format, rules and types

# The rooms whose files differ from the last commit or are new, of help pages their tests alone; or ROOMS="tests/structures tests/motions".
ROOMS ?= $(shell (git diff --name-only HEAD; git ls-files --others --exclude-standard) | sed -nE -e 's,^rocking_cli/commands/pages/.*,tests/commands/test_help.py,p;t' -e 's,^(rocking_cli|tests)/([a-z]+)/.*,tests/\2,p' | sort -u)
# What says where a word of a registry is missing.
REGISTRIES := tests/test_registries.py tests/test_plugins.py
quick: $(STAMPS)/dev ## What a small change needs: rules, types, the registries, and the quick tests of the rooms that it touches
	@began=$$(date +%s); \
	  .venv/bin/ruff check --quiet . && .venv/bin/ruff format --check . || exit 1; \
	  .venv/bin/mypy & types=$$!; \
	  .venv/bin/python -m pytest -n 2 -m 'not soak and not slow' $(REGISTRIES) $(wildcard $(ROOMS)); tests=$$?; \
	  wait $$types || tests=1; \
	  echo "$$(($$(date +%s) - began)) s: rules, types, registries, $(or $(wildcard $(ROOMS)),no room)"; exit $$tests

# A worktree may link the .venv of another checkout: it is used as it stands, with the package that stands here.
LINKED := $(shell test -L .venv && echo linked)
ifdef LINKED
export PYTHONPATH = $(CURDIR)
endif
$(STAMPS)/install: $(if $(LINKED),,pyproject.toml)
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
	.venv/bin/python -m pytest -n 2
	touch $@

$(STAMPS)/lint: $(STAMPS)/dev $(CODE) $(TESTS)
	.venv/bin/ruff format --check .
	.venv/bin/ruff check .
	.venv/bin/mypy
	touch $@

docs: $(STAMPS)/dev ## The documentation site: README, help pages, docstrings, tutorials and a gallery, out/docs
	.venv/bin/python -m pip install --quiet --disable-pip-version-check --editable '.[docs]'
	.venv/bin/python .ci/site.py out/docs

# Figs. 2 to 8 of the paper: Fig. 4 over r_b/H, Fig. 6 for a continuous arch with beta = 150 to 180 deg and t/r = 0.12 to 0.2.
ROCKING := .venv/bin/rocking
FIG := out/figures
figures: $(STAMPS)/dev ## The figures of the paper, out/figures
	mkdir -p $(FIG)
	$(ROCKING) spectrum --eta 0.9 --grid A=0.2:12:600,Omega=0.2:8:500 -o $(FIG)/fig2.h5 --overwrite
	$(ROCKING) plot $(FIG)/fig2.h5 -o $(FIG)/fig2_left.png --overwrite
	$(ROCKING) spectrum --eta 0.7 --eta 0.8 --eta 0.9 --eta 1 --grid A=0.5:8:600,Omega=4:5:2 -o $(FIG)/fig2_right.h5 --overwrite
	$(ROCKING) plot $(FIG)/fig2_right.h5 --slice Omega=5 -o $(FIG)/fig2_right.png --overwrite
	$(ROCKING) draw configs/spire.yaml configs/spire_cracked.yaml configs/arch.yaml -o $(FIG)/fig3_5.png --overwrite
	$(ROCKING) params configs/spire_cracked.yaml --vary base_radius=0.9:3:22 --vary height=8:16:3 --csv -q > $(FIG)/fig4.csv || test $$? = 4
	$(ROCKING) plot $(FIG)/fig4.csv --over base_radius/height -o $(FIG)/fig4.png --overwrite
	$(ROCKING) params arch:10x1.5x157.5deg --vary thickness=1.2:2:33 --vary angle=150:180:4 --csv -q > $(FIG)/fig6.csv
	$(ROCKING) plot $(FIG)/fig6.csv -o $(FIG)/fig6.png --overwrite
	$(ROCKING) response configs/arch.yaml --release 0.6 --model both --duration 3 --csv > $(FIG)/fig7b.csv
	$(ROCKING) plot $(FIG)/fig7b.csv -o $(FIG)/fig7b.png --overwrite
	for t in 0.36 0.40 0.44; do \
	  $(ROCKING) response configs/arch.yaml --pulse rectangular-impulse --a-g 1g --T-g $$t --model both --duration 5 --csv > $(FIG)/t_p=$$t.csv || exit 1; done
	$(ROCKING) plot $(FIG)/t_p=0.36.csv $(FIG)/t_p=0.40.csv $(FIG)/t_p=0.44.csv -o $(FIG)/fig7d.png --overwrite
	$(ROCKING) draw configs/block.yaml configs/spire.yaml configs/arch.yaml -o $(FIG)/fig8a.png --overwrite
	$(ROCKING) compare configs/block.yaml configs/spire.yaml configs/arch.yaml --A 2 --Omega 4 --eta 0.8 --curves --csv > $(FIG)/fig8.csv
	$(ROCKING) plot $(FIG)/fig8.csv -o $(FIG)/fig8bcd.png --overwrite

# How often the linear equation calls safe what overturns: blocks of b/h from 0.05 to 0.6 over A and Omega.
STUDY := out/study
study: $(STAMPS)/dev ## How often the linear equation calls safe what overturns
	mkdir -p $(STUDY)
	$(ROCKING) params configs/block.yaml --vary width=0.1:1.2:12 --json -q > $(STUDY)/blocks.jsonl
	$(ROCKING) spectrum $(STUDY)/blocks.jsonl --grid A=1:8:281,Omega=1:8:57 --model both --tolerance 1e-6 -o $(STUDY)/validity.h5 --overwrite
	$(ROCKING) plot $(STUDY)/validity.h5 --all -o $(STUDY)/validity.png --overwrite
	.venv/bin/python tests/bench/validity.py $(STUDY)/validity.h5

# How often the methods of the Italian code accept an amplitude that overturns, for columns and walls under the shipped motion.
code-study: $(STAMPS)/dev ## How often the methods of the Italian code are unsafe
	.venv/bin/python tests/bench/code_study.py

bench: $(STAMPS)/dev ## Speed and error of every scene
	.venv/bin/python -m pip install --quiet --disable-pip-version-check --editable '.[bench]'
	.venv/bin/python tests/bench/bench.py
	PYTHONPATH=tests .venv/bin/python tests/support/shown_commands.py
	.venv/bin/python tests/bench/left_out.py
	rm -rf out/base && mkdir -p out/base && git archive $(BASE) rocking_cli | tar -x -C out/base
	PYTHONPATH=tests:$(CURDIR) .venv/bin/python tests/bench/waiting.py --base out/base

# Records at the scale of a database, minutes: 200 x 10^4 cells, the nonlinear equation, first and all intervals of overturning.
database: $(STAMPS)/dev ## Records at the scale of a database, minutes
	.venv/bin/python tests/bench/database.py

# Which results of a commit the working tree changes, by bits: make golden BASE=HEAD.
BASE ?= HEAD
golden: $(STAMPS)/dev ## Which results of the commit BASE the working tree changes, by bits
	rm -rf out/golden && mkdir -p out/golden/base && git archive $(BASE) rocking_cli | tar -x -C out/golden/base
	PYTHONPATH=$(CURDIR)/out/golden/base .venv/bin/python tests/bench/golden.py write out/golden/base.npz
	PYTHONPATH=$(CURDIR) .venv/bin/python tests/bench/golden.py compare out/golden/base.npz

# Where the time of a scene goes, function by function: make trace SCENE="linear arch", all scenes without.
trace: $(STAMPS)/dev ## Where the time of a scene goes: make trace SCENE="linear arch"
	.venv/bin/python tests/bench/scenes.py $(SCENE)

soak: $(STAMPS)/dev ## The long checks
	.venv/bin/python -m pytest -m soak

# OpenQuake and pelicun stand in environments of their own; of OpenQuake only what its reader of fragility models imports.
READ := .venv/readers
readers: $(STAMPS)/dev ## Exported fragility curves, read by OpenQuake and pelicun themselves
	$(PYTHON) -m venv $(READ)/openquake && $(PYTHON) -m venv $(READ)/pelicun
	$(READ)/pelicun/bin/pip install --quiet pelicun
	$(READ)/openquake/bin/pip install --quiet --no-deps openquake.engine
	$(READ)/openquake/bin/pip install --quiet numpy scipy h5py pandas toml psutil decorator pyzmq shapely pyproj requests numba h3 alpha_shapes fiona
	PYTHON_OPENQUAKE=$(READ)/openquake/bin/python PYTHON_PELICUN=$(READ)/pelicun/bin/python \
	  .venv/bin/python -m pytest -m soak tests/fragility/test_exports.py

# The numeric tests with other processors' kernels of OpenBLAS, NumPy and the C library.
ladder: $(STAMPS)/dev ## The numeric tests with other processors' kernels
	.venv/bin/python tests/bench/ladder.py

# Which of the tests that run a changed line of a room notice the change.
ROOM ?= dynamics
mutants: $(STAMPS)/dev ## Which changes of a sign or a constant the tests notice: make mutants ROOM=dynamics
	.venv/bin/python -m pip install --quiet --disable-pip-version-check --editable '.[mutants]'
	.venv/bin/python tests/bench/mutants.py $(ROOM)

clean: ## Remove all that was made
	rm -rf .venv out dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
