# Two commands do all the set-up on a fresh machine: `make demo` and `make test`.
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help

VENV := .venv
PYTHON ?= $(shell for p in python3.13 python3.12 python3.11 python3; do \
  command -v $$p >/dev/null 2>&1 && $$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$p && break; done)
NATIVE := Cargo.toml Cargo.lock $(shell find planner/native semantic_attachments/native simulator/native \
  -name '*.rs' -o -name Cargo.toml | grep -v '/target/')
export CARGO_TARGET_DIR ?= target

.PHONY: help demo test test-all lint format build bench clean tools

help: ## this list
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /  make \1\t/' | expand -t 18

tools:
	@test -n "$(PYTHON)" || { echo "marsupial needs Python 3.11 or newer as python3 (Debian: apt-get install python3 python3-venv)."; exit 1; }
	@command -v cc >/dev/null || { echo "marsupial needs a C compiler as cc to link its Rust core (Debian: apt-get install gcc)."; exit 1; }
	@command -v cargo >/dev/null || { echo "marsupial needs cargo to build its Rust core (install Rust 1.90 or newer with rustup: https://rustup.rs)."; exit 1; }

$(VENV)/.requirements: requirements.lock | tools
	@test -x $(VENV)/bin/python || $(PYTHON) -m venv $(VENV)
	$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check -r requirements.lock
	@touch $@

$(VENV)/.installed: $(VENV)/.requirements pyproject.toml $(NATIVE)
	$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	@touch $@

build: $(VENV)/.installed ## create .venv, build the Rust core in release mode, install
	@$(VENV)/bin/python -m compileall -q planner semantic_attachments domains service simulator scenarios

demo: build ## run the hospital mission and write its report
	$(VENV)/bin/marsupial demo

lint: build ## ruff, mypy --strict, cargo fmt, clippy; warnings are errors
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/mypy
	cargo fmt --all --check
	PYO3_PYTHON=$(CURDIR)/$(VENV)/bin/python cargo clippy --quiet --workspace --all-targets --all-features -- -D warnings

format: build ## rewrite Python and Rust sources in the house style
	$(VENV)/bin/ruff check --fix --quiet . || true
	$(VENV)/bin/ruff format .
	cargo fmt --all

test: build ## Rust and Python tests that run in minutes
	cargo test --quiet --workspace --exclude planner_native
	$(VENV)/bin/python -m pytest -m "not slow"

test-all: build ## also the slow tests: kills, fuzzing, browser
	cargo test --quiet --workspace --exclude planner_native
	$(VENV)/bin/python -m pytest

bench: build ## every benchmark, in its quick form
	$(VENV)/bin/marsupial bench all --quick

clean: ## remove what the build made
	rm -rf $(VENV) target build dist ./*.egg-info
