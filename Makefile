# Every target builds .venv from pinned wheels first; nothing else is needed.
SHELL := /bin/sh
BIN := .venv/bin
SUPPORTED := python3.11 python3.12 python3.10 python3.13 python3
CHECK := import ensurepip, sys, venv; sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, 13))
PYTHON ?= $(shell for name in $(SUPPORTED); do $$name -c '$(CHECK)' >/dev/null 2>&1 \
	&& { echo $$name; break; }; done)
PIP_INSTALL := $(BIN)/python -m pip install -qq --disable-pip-version-check

# The wheels bring a ROS 2 of their own, into which a sourced one must not mix.
unexport AMENT_PREFIX_PATH PYTHONHOME PYTHONPATH RMW_IMPLEMENTATION _ROS_WHEELS_BOOTSTRAP_COMPLETE
# Nodes are processes that start often: none compiles the sources anew.
unexport PYTHONDONTWRITEBYTECODE
# The matrices are small: threads of the linear algebra would only wait for each other, busily.
export OPENBLAS_NUM_THREADS := 1
ifdef ROS_DISTRO
unexport LD_LIBRARY_PATH
endif

.PHONY: help demo play faults fuzz test test-fast lint lint-style lint-types docs lock clean
.DEFAULT_GOAL := help

help: ## list the targets
	@sed -n 's/^\([a-z-]*\):.*## /make \1	/p' $(MAKEFILE_LIST)

demo: .venv/installed ## push a box to its goal over DDS; results in out/
	$(BIN)/push replay --demo --out out

play: .venv/installed ## open a page on which you drag goal and box, draw walls, change friction
	$(BIN)/push play $(ARGS)

faults: .venv/installed ## how faults of sensors, base and processes end; half an hour
	$(BIN)/python -m benchmarks.faults

fuzz: .venv/installed ## random messages, files, parameters and orders of events; STEPS=100000 for hours
	PUSH_CONTROL_FUZZ=$(or $(STEPS),3000) $(BIN)/python -m pytest -q $$(find test -name 'test_fuzz_*.py')

PYTEST := $(BIN)/python -m pytest --numprocesses auto --dist loadfile

test: .venv/installed ## all tests, on all cores; ARGS="-k contact" for some
	$(PYTEST) $(ARGS)

test-fast: .venv/installed ## the tests that are neither slow nor need DDS: under a minute
	$(PYTEST) -m 'not slow and not dds' $(ARGS)

lint: lint-style lint-types ## style, architecture and types; side by side with -j2

lint-style: .venv/linters
	$(BIN)/python -m pytest -q test/architecture/test_style.py test/architecture/test_architecture.py

lint-types: .venv/linters
	$(BIN)/basedpyright

docs: .venv/docs ## the documentation as a site with search: out/docs/index.html
	$(BIN)/python -m sphinx --quiet --fail-on-warning --keep-going docs out/docs

# Pins that are there stay, unless requirements.in forbids them; ARGS="--upgrade-package scipy"
# moves one, ARGS=--upgrade all. The markers hold for every Python from the oldest on.
lock: ## pin what requirements.in asks for
	$(PYTHON) -m venv --clear build/lock
	build/lock/bin/python -m pip install -qq --disable-pip-version-check uv==0.13.9
	build/lock/bin/uv pip compile --quiet --universal --python-version 3.10 --no-annotate \
		--custom-compile-command 'make lock' $(ARGS) requirements.in -o requirements.txt

clean: ## remove everything made here
	rm -rf .venv out build install log *.egg-info .pytest_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

.venv/requirements: requirements-build.txt requirements.txt
	@test -n '$(PYTHON)' || { echo 'make: no Python 3.10 to 3.13 with venv found among' \
		'$(SUPPORTED); name one with PYTHON=/path/to/python' >&2; exit 1; }
	@echo 'Installing pinned wheels into .venv: about a minute.'
	$(PYTHON) -m venv --clear .venv
	$(PIP_INSTALL) -r requirements-build.txt
	$(PIP_INSTALL) --no-build-isolation -r requirements.txt
	@touch $@

# Editable: what runs is the source tree, so only packaging changes need a new installation.
.venv/installed: .venv/requirements setup.py pyproject.toml package.xml \
		$(wildcard push_*/__init__.py push_*/*/__init__.py push_*/*/*/__init__.py)
	$(PIP_INSTALL) --no-deps --no-build-isolation --editable .
	@touch $@

# The type checker brings a Node.js of its own, which the package itself does not need.
.venv/linters: .venv/installed requirements-lint.txt
	$(PIP_INSTALL) -r requirements-lint.txt
	@touch $@

.venv/docs: .venv/installed requirements-docs.txt
	$(PIP_INSTALL) -r requirements-docs.txt
	@touch $@
