# Two commands are enough: `make proofs` and `make test`. Each sets up .venv on its first call.

PYTHON ?= python3
BIN := .venv/bin

.PHONY: proofs test lint thorough long clean

proofs: .venv
	$(BIN)/python -m pytest proofs

test: .venv
	$(BIN)/python -m pytest -n 2

lint: .venv
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

thorough: .venv
	HYPOTHESIS_PROFILE=thorough $(BIN)/python -m pytest -n 2

long: .venv
	$(BIN)/python -m pytest -n 2 -m long

.venv: requirements.lock pyproject.toml
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-build-isolation --no-deps -e .
	touch .venv

clean:
	rm -rf .venv dist .hypothesis .mypy_cache .ruff_cache
