# Two commands do everything on a fresh machine: `make demo` and `make test`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Small matrices: a second BLAS thread only takes the other worker's core.
export OPENBLAS_NUM_THREADS := 1
# What Python has compiled serves the other processes of a run, and the next run.
unexport PYTHONDONTWRITEBYTECODE
STAMP := $(VENV)/.installed
STAMP_SLOW := $(VENV)/.installed-slow

.PHONY: help demo gallery test test-slow test-arithmetic test-casadi-before fuzz bench dial lint format schema api docs generated clean

help:
	@echo "make demo       set up .venv, solve a handful of example scenes, write results, figures and C sources to out/"
	@echo "make gallery    solve the other examples too, and draw the motions (minutes)"
	@echo "make test       set up .venv, check style, types and imports, run the tests"
	@echo "make test-slow  the long sweeps that 'make test' leaves out"
	@echo "make test-ROOM  the tests in tests/ROOM: make test-rod, make test-codegen"
	@echo "make test-arithmetic  the quick numerical tests once more under the rounding of other processors and compilers"
	@echo "make test-casadi-before  the quick tests with the minor version of CasADi before the newest, in .venv-casadi-before"
	@echo "make fuzz       10^4 random scenes at the ends of what is legal; writes figures to docs/hard-cases.md (hours)"
	@echo "make bench      race the exported C and motions against shooting solvers and packages; writes tables and figures"
	@echo "make dial       judge what tolerances pick on 200 random scenes, resumable; writes tables and figure"
	@echo "make format     format the sources"
	@echo "make generated  write the C folders in generated/ anew"
	@echo "make schema     write the JSON schema and the reference of the scene format anew"
	@echo "make api        write docs/api anew from the docstrings, examples/notebook.ipynb from its page"
	@echo "make docs       build the site of all pages, with a gallery of the examples, in build/site"

$(STAMP): pyproject.toml
	$(PYTHON) -m venv $(VENV)
	# The pip of earlier versions of Python takes half as long again: it compares all tags of all wheels.
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile --upgrade pip
	# Compiled when it is imported: most modules of these packages never are.
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile --editable '.[test]'
	@touch $@

# What the site and the long tests need besides.
$(STAMP_SLOW): $(STAMP)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile --editable '.[test-slow]'
	@touch $@

demo: $(STAMP)
	$(BIN)/python examples/demo.py --output out

gallery: demo
	$(BIN)/python examples/demo.py --output out --rest

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

test: $(STAMP) lint
	$(BIN)/python -m pytest -n 2 --dist loadfile -m "not slow"

test-slow: $(STAMP_SLOW)
	$(BIN)/python -m pytest -n 2 --dist loadfile -m slow

# Rounds as other processors, BLAS threads and optimised C do; what this processor cannot run is said and left out.
test-arithmetic: $(STAMP)
	$(BIN)/python -m tests.arithmetic

# pyproject.toml admits two minor versions of CasADi; `make test` takes the newest, this the one before.
test-casadi-before:
	$(PYTHON) -m venv $(VENV)-casadi-before
	$(VENV)-casadi-before/bin/python -m pip install --quiet --no-compile --editable '.[test]' 'casadi<3.8'
	$(VENV)-casadi-before/bin/python -m pytest -n 2 --dist loadfile -m "not slow"

test-%: $(STAMP)
	$(BIN)/python -m pytest -n 2 --dist loadfile -m "not slow" tests/$*

fuzz: $(STAMP)
	$(BIN)/python benchmarks/fuzz.py --write --log out/fuzz.jsonl
	$(BIN)/python benchmarks/held_rods.py

bench: $(STAMP)
	-$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[bench]'
	-$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[bench-motion]'
	$(BIN)/python benchmarks/race.py --write
	$(BIN)/python benchmarks/motion_precision.py --write
	$(BIN)/python benchmarks/motion_peers.py --write
	$(BIN)/python benchmarks/motion_robots.py --write

dial: $(STAMP)
	$(BIN)/python benchmarks/compiled_cost.py --write
	$(BIN)/python benchmarks/dial.py --write

format: $(STAMP)
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

schema: $(STAMP)
	$(BIN)/python -m cosserat_casadi.scene.json_schema
	$(BIN)/python docs/scene_reference.py

api: $(STAMP)
	$(BIN)/python docs/api_pages.py
	$(BIN)/python docs/notebook_file.py

docs: $(STAMP_SLOW)
	$(BIN)/python -m docs.site --output build/site --runs out

# Solves the scenes for their discretisation, then runs the comparison that 'make test' makes.
generated: $(STAMP)
	$(BIN)/python -m pytest tests/codegen/test_generated.py --update-generated

clean:
	rm -rf $(VENV) build out .pytest_cache .mypy_cache .ruff_cache .hypothesis
