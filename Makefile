# Two commands are enough: `make proofs` and `make test`. Each sets up .venv on its first call.

PYTHON ?= python3
# Where it is set, each process compiles all test files anew, for half a minute.
unexport PYTHONDONTWRITEBYTECODE
BIN := .venv/bin
PEERS := build/peers

.PHONY: proofs kernel test slow lint thorough long mutants docs site bench clean

proofs: .venv
	$(BIN)/python -m pytest -rs proofs

# What Coq accepts of the ledger: minutes, and Coq with libraries from Debian's packages, which it names if they are missing.
kernel: .venv
	$(BIN)/python -m proofs.kernel

test: .venv
	$(BIN)/python -m pytest -n 2

# The cases that `make test` leaves out because they take seconds each.
slow: .venv
	$(BIN)/python -m pytest -n 2 -m "slow and not long" tests

lint: .venv
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

thorough: .venv
	HYPOTHESIS_PROFILE=thorough $(BIN)/python -m pytest -n 2 -m "not long"

long: .venv
	$(BIN)/python -m pytest -n 2 -m long

# Small errors planted in copies of the package, and whether the tests notice: an hour, and docs/mutants.md.
mutants: .venv
	$(BIN)/python -m tests.campaigns.mutants

# The numbers, sessions and tables of docs/, written anew; those of the lesson where its text is at hand.
docs: .venv
	$(BIN)/python docs/pages.py
	if test -f ../shared/lesson/lesson.txt; then $(BIN)/python docs/lesson_tables.py; fi

# The documentation as web pages in build/site: the pages of docs/, and the reference from the docstrings.
SITE := build/site-environment
site: $(SITE)
	$(SITE)/bin/python -m sphinx --fail-on-warning --keep-going --quiet -b html docs build/site
	@echo "open build/site/index.html"

$(SITE): requirements.lock docs/requirements.txt
	$(PYTHON) -m venv $(SITE)
	$(SITE)/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	$(SITE)/bin/python -m pip install --quiet --disable-pip-version-check -r docs/requirements.txt
	touch $(SITE)

# Times beside NodePy, kauri, RKkit, SciPy, diffrax and heyoka, and their answers: about a quarter of an hour. RKkit needs
# 2 GB of Sage, and is left out of the report where that cannot be had.
bench: $(PEERS)
	$(PEERS)/bin/python -m benchmarks

$(PEERS): requirements.lock benchmarks/peers.txt
	$(PYTHON) -m venv $(PEERS)
	$(PEERS)/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	$(PEERS)/bin/python -m pip install --quiet --disable-pip-version-check -r benchmarks/peers.txt
	-$(PEERS)/bin/python -m pip install --quiet --disable-pip-version-check 'RKkit[passagemath]==0.1.8'
	touch $(PEERS)

# On a terminal the seconds stand in the line where nothing else does, until the shell has ended.
SECONDS_TOLD = if test -t 2; then (s=0; while sleep 2 && kill -0 $$$$ 2>&-; do s=$$((s + 2)); printf '%s s\r' $$s >&2; done) & fi

.venv: requirements.lock pyproject.toml
	@echo "making .venv with what the proofs and tests need, once: a minute or two"
	@set -e; $(SECONDS_TOLD); set -x; $(PYTHON) -m venv .venv; \
	$(BIN)/python -m pip install --disable-pip-version-check --require-hashes -r requirements.lock; \
	$(BIN)/python -m pip install --disable-pip-version-check --no-build-isolation --no-deps -e .
	touch .venv

clean:
	rm -rf .venv build dist .hypothesis .mypy_cache .ruff_cache

# Identifies steppers of some forty other packages, which want an environment of their own, and writes docs/gallery.md,
# and docs/gallery_solvers.md of whole solvers.
GALLERY := build/gallery

.PHONY: gallery

gallery: $(GALLERY)
	$(GALLERY)/bin/python examples/gallery/convergence.py > examples/gallery/findings.md
	$(GALLERY)/bin/python examples/gallery/convergence.py --solvers > examples/gallery/solver_findings.md
	$(GALLERY)/bin/python -m examples.gallery.run
	$(GALLERY)/bin/python -m examples.gallery.run --solvers

$(GALLERY): examples/gallery/requirements.txt
	$(PYTHON) -m venv $(GALLERY)
	$(GALLERY)/bin/python -m pip install --quiet --disable-pip-version-check torch==2.13.0
	$(GALLERY)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps -r examples/gallery/requirements.txt
	$(GALLERY)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps -e .
	touch $(GALLERY)
