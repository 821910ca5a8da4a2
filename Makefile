# Everything a checkout can do by itself. The first target of the day installs into .venv.
#
#   make demo      a phantom heart through the whole service, into ./demo
#   make test      every test
#   make check     static checks, known vulnerabilities, every test; CI runs it without the second
#   make audit     known vulnerabilities of what constraints.txt pins; says so where nobody can be asked
#   make bench     accuracy and speed beside classical methods, into docs/benchmarks.md; half an hour
#   make bench-beating  hearts over a whole cycle, into docs/benchmarks/beating.md; twenty minutes
#   make openapi   write openapi.yaml anew from the code
#   make clean     remove .venv, caches and ./demo
#
# PYTHON=...           the interpreter to build .venv with: 3.11 or 3.12
# TORCH_INDEX_URL=...  an index of CPU builds of torch, where the default one serves GPU builds

VENV ?= .venv
TORCH_INDEX_URL ?=

BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed
FITS := import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 12))
# The first on the PATH that fits; left empty where none does.
PYTHON ?= $(shell for p in python3 python3.12 python3.11; do \
	$$p -c '$(FITS)' 2>/dev/null && echo $$p && break; done)

.PHONY: demo test bench bench-beating lint audit check openapi install clean
.DELETE_ON_ERROR:

demo: install
	$(BIN)/neuralmri demo

test: install
	$(BIN)/python -m pytest

# CASES=DIR adds cases with references: DIR/*/contours.json and reference/{surface}.ply
bench: install
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[bench]'
	$(BIN)/python -m benchmarks.holdout $(if $(CASES),--cases '$(CASES)')
	$(BIN)/python -m benchmarks $(if $(CASES),--cases '$(CASES)')

# DATA=DIR has bivme_guide_points/; ONLY=PART measures one part: patient1, sliced, phantom, killed
bench-beating: install
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[bench]'
	$(BIN)/python -m benchmarks.beating $(if $(DATA),--data '$(DATA)') $(if $(ONLY),--only '$(ONLY)')

lint: install
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python -m service.openapi | diff openapi.yaml - \
		|| { echo 'openapi.yaml is not what the code says; run: make openapi' >&2; exit 1; }

audit: install
	@$(BIN)/python -c 'import pip_audit' 2>/dev/null \
		|| $(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[audit]' || true
	$(BIN)/python .ci/audit.py

check: lint audit test

openapi: install
	$(BIN)/python -m service.openapi > openapi.yaml

install: $(INSTALLED)

$(INSTALLED): pyproject.toml constraints.txt
	@'$(or $(PYTHON),false)' -c '$(FITS)' || { \
		echo 'neuralmri needs Python 3.11 or 3.12, and $(or $(PYTHON),python3) is not;' \
			'name one with: make PYTHON=/path/to/python3.12' >&2; exit 1; }
	@echo 'Building the environment in $(VENV): a minute or two, 2 GB.'
	@'$(PYTHON)' -m venv '$(VENV)'
ifneq ($(TORCH_INDEX_URL),)
	@$(BIN)/python -m pip install --quiet --no-deps --constraint constraints.txt \
		--index-url '$(TORCH_INDEX_URL)' torch
endif
	@$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[test]'
	@$(BIN)/python -c 'import torch; raise SystemExit(torch.version.cuda is not None)' || { \
		echo 'torch is not a CPU build (or does not load): gigabytes of GPU libraries that nothing' \
			'here uses. Run: make clean, then name an index of CPU builds:' \
			'make TORCH_INDEX_URL=<index of CPU wheels, see README>' >&2; exit 1; }
	@touch '$(INSTALLED)'

clean:
	rm -rf '$(VENV)' build dist demo *.egg-info
	rm -rf .mypy_cache .pytest_cache .ruff_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
