# The two commands: `make demo` runs the main job, `make test` passes the tests.
# Both set everything up in .venv first; nothing outside this folder is touched.

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
SHELL := /bin/sh

VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
TESTS_READY := $(VENV)/.ready-tests
DEMO := build/demo

# The first interpreter that is 3.11 or newer; `make PYTHON=/path/to/python3` overrides.
PYTHON ?= $(shell for p in python3.11 python3.12 python3.13 python3; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$p && break; \
	done)

.PHONY: help setup demo serve kernels test test-slow shuffled check bench docs lock clean

help:
	@echo "make demo   optimise a sample part, simulate it, run it under control, and learn from it"
	@echo "make serve  the dashboard and REST at http://127.0.0.1:8000 (PORT=8000)"
	@echo "make test   run the tests, but for the slow ones: under 8 minutes on two cores"
	@echo "make test-slow  run the slow ones: sweeps, kills, browsers, whole programs"
	@echo "make shuffled  run a share of the quick tests in another order, in a clone (SEED=1 repeats one)"
	@echo "make check  formatting, lint, types, layers"
	@echo "make bench  speed, side by side with peers"
	@echo "make docs   the documentation as a site, in build/site"
	@echo "make setup  only install into $(VENV)"

setup: $(READY)

# Where Python writes no bytecode, as in some containers, each command would compile all that it
# loads. It is written on first use: installing compiles nothing, and nothing unused is compiled.
unexport PYTHONDONTWRITEBYTECODE

$(READY): requirements.lock pyproject.toml
	@test -n "$(PYTHON)" || { echo "error: Python 3.11 or newer is needed: apt-get install python3 python3-venv" >&2; exit 1; }
	@"$(PYTHON)" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || \
		{ echo "error: $(PYTHON) is older than Python 3.11: apt-get install python3 python3-venv" >&2; exit 1; }
	@command -v uv >/dev/null 2>&1 || "$(PYTHON)" -c 'import ensurepip, venv' 2>/dev/null || \
		{ echo "error: the venv module is missing: apt-get install python3-venv" >&2; exit 1; }
	@if command -v uv >/dev/null 2>&1; \
		then uv venv --quiet --allow-existing --python "$(PYTHON)" $(VENV); \
		else "$(PYTHON)" -m venv $(VENV); fi
	@$(INSTALL) --require-hashes -r requirements.lock
	@$(INSTALL) --no-deps --no-build-isolation --editable .
	@touch $@

# What only tests, checks, benchmarks and the documentation need, all extras among them.
$(TESTS_READY): requirements-dev.lock $(READY)
	@$(INSTALL) --require-hashes -r requirements-dev.lock
	@touch $@

# uv where there is one; it compiles nothing either.
INSTALL = $$(command -v uv >/dev/null 2>&1 && echo "uv pip install --quiet --python $(VENV)" || \
	echo "$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile")

demo: $(READY)
	@mkdir -p $(DEMO)
	$(BIN)/stepnc check examples/parts/bracket.stpnc
	$(BIN)/optimise examples/parts/paper002.stpnc --mode TC --machine vmc15 --material c45 \
		-o $(DEMO)/paper002.optimised.stpnc
	$(BIN)/optimise examples/parts/bracket.stpnc --mode TC --machine vmc15 \
		-o $(DEMO)/bracket.optimised.stpnc --report $(DEMO)/bracket.html --nc linuxcnc
	$(BIN)/stepnc simulate $(DEMO)/bracket.optimised.stpnc --machine vmc15 \
		-o $(DEMO)/bracket.run.csv --report $(DEMO)/bracket.run.html
	rm -f $(DEMO)/knowledge.db*
	$(BIN)/stepnc control $(DEMO)/paper002.optimised.stpnc --machine vmc15 --material c45 --preview \
		--disturb kc:1.2 --kb $(DEMO)/knowledge.db -o $(DEMO)/paper002.control.csv \
		--report $(DEMO)/paper002.control.html
	$(BIN)/stepnc kbe review --kb $(DEMO)/knowledge.db
	$(BIN)/stepnc kbe table --kb $(DEMO)/knowledge.db -o $(DEMO)/knowledge.html
	@echo "look at: $(DEMO)/bracket.html, bracket.run.html, paper002.control.html, knowledge.html"

# Kernels are compiled before tests: workers that make the same ones at once would wait for each
# other and keep 450 MB of a compiler each, and what the first command says of it is no part of what
# a test looks at. Their files are named by content, so any checkout may take them from another.
KERNELS := build/.kernels
SOURCES := $(shell find stepnc_model simulator optimiser controller service extras -name '*.py')

kernels: $(KERNELS)

# Checking a log against a program needs an extra, so the tests' environment.
$(KERNELS): $(TESTS_READY) $(SOURCES)
	@mkdir -p build
	@$(BIN)/stepnc simulate examples/parts/bracket.stpnc --machine vmc15 --lag -o build/bracket.csv >/dev/null
	@$(BIN)/stepnc simulate examples/parts/shaft.stpnc --machine lathe22 >/dev/null
	@$(BIN)/stepnc optimise examples/parts/bracket.stpnc --machine vmc15 --along-path --dry-run >/dev/null
	@$(BIN)/stepnc verify build/bracket.csv --program examples/parts/bracket.stpnc --machine vmc15 >/dev/null
	@touch $@

test: $(TESTS_READY) $(KERNELS)
	$(BIN)/python -m pytest -n auto -m "not slow" --durations=20 --durations-min=1

test-slow: $(TESTS_READY) $(KERNELS)
	$(BIN)/python -m pytest -n auto -m slow --durations=20 --durations-min=1

SEED := $(or $(SEED),$(shell date +%s))
SHARE ?= 0.15

# No test may depend on its order, its worker or its folder: a share of the quick tests, others
# each time, in one of all orders, and a clone of what is committed that nobody else may enter
# (mktemp: mode 0700).
# It borrows the environment; modules that are installed there come after those of the clone.
shuffled: $(TESTS_READY) $(KERNELS)
	@echo "make shuffled SEED=$(SEED) SHARE=$(SHARE)"
	@folder=$$(mktemp -d) && trap 'rm -rf "$$folder"' EXIT && trap 'exit 130' INT TERM && \
	git clone --quiet . "$$folder/clone" && \
	ln -s "$(abspath $(VENV))" "$$folder/clone/.venv" && \
	if [ -d ../shared ]; then ln -s "$$(cd ../shared && pwd)" "$$folder/shared"; fi && \
	cp -r simulator/kernels/__pycache__ "$$folder/clone/simulator/kernels/" && \
	cd "$$folder/clone" && export PYTHONPATH="$$PWD" && \
	.venv/bin/python -m pytest -n auto -m "not slow" --shuffle $(SEED) --share $(SHARE)

check: $(TESTS_READY)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python -m benchmarks.house --check
	$(BIN)/python -m pytest -q -n0 -o verbosity_assertions=2 tests/tree

PORT ?= 8000

serve: $(READY)
	$(BIN)/stepnc serve --port $(PORT)

bench: $(TESTS_READY)
	$(BIN)/python -m benchmarks

# Whatever mkdocs would warn of is an error. The variable stills an advertisement of its theme.
docs: $(TESTS_READY)
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict --quiet
	@echo "open: build/site/index.html (its search needs a server: python3 -m http.server -d build/site)"

# Needs uv. Universal (every platform, Python 3.11 and later), hashes, no index addresses.
LOCK = uv pip compile pyproject.toml --universal --python-version 3.11 --generate-hashes \
	--no-emit-index-url --no-emit-find-links --no-header --quiet

lock:
	$(LOCK) --extra dev -o requirements-dev.lock
	$(LOCK) --constraint requirements-dev.lock -o requirements.lock

clean:
	rm -rf $(VENV) build *.egg-info .mypy_cache .pytest_cache .ruff_cache .hypothesis .import_linter_cache
