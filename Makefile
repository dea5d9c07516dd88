# make demo    a swimmer swims: numbers, pictures, a report    (installs what it needs into .venv)
# make test    everything a change must pass
# make slow    the long checks as well
# make bench   timings, written to benchmarks/results and to docs/performance.md
# make docs    the documentation, into site/; examples in docstrings run, links checked
# make site    the same without the docstrings' examples, which `make test` runs too
# make studio  the page of `microswim studio`, built anew: no difference to what is committed (wants Node 20)
# make atlas   the shipped corrections, solved and fitted anew; goes on where it was (hours; ATLAS_ARGS="--designs 8192")
# make clean   away with all that
PYTHON ?= python3
VENV   ?= .venv
PYTEST_ARGS ?= -n 2 --dist worksteal

BIN := $(VENV)/bin
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile -c constraints.txt
# pip compiles on one core, and the tests of every package too; this is quicker.
COMPILE := $(BIN)/python -m compileall -q -j 0 -x '/tests?/' $(VENV)/lib >/dev/null || true

.PHONY: demo test lint kernels slow bench docs site studio atlas clean

demo: $(VENV)/.core
	@$(BIN)/microswim demo

# One core checks while the other compiles what both workers would compile at once.
test: $(VENV)/.test
	@$(MAKE) --no-print-directory --jobs=2 lint kernels
	@$(BIN)/pytest $(PYTEST_ARGS)

kernels: $(VENV)/.test
	@$(BIN)/python -c "import microswim as ms; ms.warm_up()"

lint: $(VENV)/.test
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/pyright --pythonpath $(BIN)/python
	@$(BIN)/lint-imports

slow: $(VENV)/.test
	@$(BIN)/pytest -m "slow or not slow" $(PYTEST_ARGS)

bench: $(VENV)/.test
	@set -e; for script in benchmarks/bench_*.py; do $(BIN)/python "$$script"; done
	@$(BIN)/python benchmarks/report.py

docs: $(VENV)/.test
	@$(BIN)/pytest --quiet -n 2 src
	@$(MAKE) --no-print-directory site

site: $(VENV)/.docs $(VENV)/.test
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict
	@echo "documentation: site/index.html"

STATIC := src/microswim/studio/static
studio:
	@cd studio && npm ci --silent && npm run --silent build -- --logLevel warn
	@git diff --exit-code --stat -- $(STATIC) || { echo "the built page differs from the one committed: commit it" >&2; exit 1; }

atlas: $(VENV)/.test
	@$(BIN)/python -m microswim.calibration.atlas.campaign build/atlas $(ATLAS_ARGS)

clean:
	rm -rf $(VENV) site build dist out .pytest_cache .ruff_cache .hypothesis .import_linter_cache .numba_cache
	find src tests examples benchmarks -name __pycache__ -prune -exec rm -rf {} + 2>/dev/null || true

# One stamp for each set of extras: a second call installs nothing.
$(VENV)/.core: pyproject.toml constraints.txt
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@echo "installing microswim into $(VENV) ..."
	@$(INSTALL) -e .
	@$(COMPILE)
	@touch $@

$(VENV)/.test: $(VENV)/.core
	@echo "installing the test tools and extras into $(VENV) ..."
	@$(INSTALL) -e ".[test]"
	@$(COMPILE)
	@touch $@

$(VENV)/.docs: $(VENV)/.core
	@echo "installing the documentation tools into $(VENV) ..."
	@$(INSTALL) -e ".[docs]"
	@$(COMPILE)
	@touch $@
