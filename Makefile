# Everything a person needs to type. Only Python 3.11+, git and make have to be there.
#   make run     install what is pinned, reproduce the default branch, say where the page is (BRANCH=NAME for another one)
#   make test    install if need be, run linters, type checker, import contracts and tests
#   make docs    build the documentation site into build/site, with what each tutorial prints and draws (some minutes)
#   make prove   the concealed benchmark: SEED=1 CASES=60 (of each kind) KIND=quadrotor,joint,swerve
#   make bench   measure the simulator beside its peers, write docs/benchmark.md (leave the machine alone meanwhile)
#   make bench-training   measure training beside its bare loop, write docs/benchmark_training.md
#   make bench-reading    measure how fast logs are read, write docs/benchmark_reading.md
#   make bench-diagnosis  measure the time of diagnoses, write docs/benchmark_diagnosis.md (SEED, CASES as above)
#   make bench-policies   measure PPO on the racing quadrotor beside a bare loop, write docs/benchmark_policies.md
# The pins in constraints.txt are made by:
#   uv pip compile pyproject.toml --all-extras --universal --python-version 3.11 --no-header --no-annotate \
#       --no-emit-index-url -o constraints.txt

PYTHON ?= python3
BRANCH ?=
SEED ?= 1
CASES ?= 60
KIND ?= quadrotor,joint,swerve
BIN := .venv/bin
STAMP := .venv/.installed

.PHONY: run test quick checks docs site prove bench bench-training bench-reading bench-diagnosis bench-policies lint install

run: $(STAMP)
	@$(BIN)/simgap reproduce $(BRANCH)

# Beside the checks, which use one core, the tests that are quick begin. Byte code is kept, also where that was switched
# off: tests start many programs, each of which would compile the whole project.
test: export PYTHONDONTWRITEBYTECODE :=
test: export OMP_NUM_THREADS := 1
test: $(STAMP)
	@$(MAKE) --no-print-directory --jobs 2 checks quick
	@$(BIN)/pytest -n 2 --dist worksteal -m slow

quick: $(STAMP)
	@$(BIN)/pytest -n 2 --dist worksteal -m "not slow"

# One after the other: both lay out the package.
checks:
	@$(MAKE) --no-print-directory lint
	@$(MAKE) --no-print-directory site

prove: $(STAMP)
	@$(BIN)/simgap prove seed=$(SEED) prove.cases=$(CASES) 'prove.kinds=[$(KIND)]'

lint: $(STAMP)
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/python -m tools.link_package build/package
	@$(BIN)/mypy
	@PYTHONPATH=build/package $(BIN)/lint-imports

# The site with warnings as errors; quick, because tutorials are shown without being run.
site: $(STAMP)
	@$(BIN)/python -m tools.link_package build/package
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet

docs: $(STAMP)
	@$(BIN)/python -m tools.sentences README.md docs
	@SIMGAP_RUN_TUTORIALS=1 $(MAKE) --no-print-directory site
	@echo "the site: build/site/index.html"

bench: $(STAMP) .venv-bench/.installed
	@$(BIN)/python -m benchmarks --peers .venv-bench/bin/python --output docs/benchmark.md

bench-training: $(STAMP)
	@$(BIN)/python -W ignore -m benchmarks.training --output docs/benchmark_training.md

bench-reading: export OMP_NUM_THREADS := 1
bench-reading: $(STAMP)
	@$(BIN)/python -W ignore -m benchmarks.reading --output docs/benchmark_reading.md

bench-diagnosis: export OMP_NUM_THREADS := 1
bench-diagnosis: $(STAMP)
	@rm -rf build/bench_diagnosis
	@$(BIN)/simgap prove seed=$(SEED) prove.cases=$(CASES) 'prove.kinds=[$(KIND)]' \
		prove.folder=build/bench_diagnosis/cases output=build/bench_diagnosis
	@$(BIN)/python -W ignore -m benchmarks.diagnosis --results build/bench_diagnosis/results.json \
		--output docs/benchmark_diagnosis.md --command 'make bench-diagnosis SEED=$(SEED) CASES=$(CASES)'

bench-policies: $(STAMP)
	@$(BIN)/python -W ignore -m benchmarks.policies --output docs/benchmark_policies.md

# The peers have an environment of their own: what they need is no need of the project.
.venv-bench/.installed: benchmarks/requirements.txt
	@set -e; rm -rf .venv-bench; $(PYTHON) -m venv .venv-bench; echo "installing the peers into .venv-bench"; \
	.venv-bench/bin/python -m pip install -qq --requirement benchmarks/requirements.txt; touch $@

install: $(STAMP)

# The stamp is the last thing that is written: without it, an installation was interrupted and starts from nothing. The lock
# is inherited by every program of this recipe, so that an installation that outlives its make is waited for.
$(STAMP): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or later is needed: make PYTHON=...")'
	@set -e; exec 9> .venv.lock; $(PYTHON) -c 'import fcntl; fcntl.flock(9, fcntl.LOCK_EX)'; \
	if [ $(STAMP) -nt pyproject.toml ] && [ $(STAMP) -nt constraints.txt ]; then exit 0; fi; \
	if [ ! -e $(STAMP) ]; then rm -rf .venv; $(PYTHON) -m venv .venv; fi; rm -f $(STAMP); \
	echo "installing into .venv"; \
	$(BIN)/python -m pip install -qq --constraint constraints.txt uv; \
	UV_HTTP_RETRIES=0 $(BIN)/uv pip install --quiet --python $(BIN)/python --torch-backend=auto \
		--constraint constraints.txt torch 2> /dev/null \
		|| $(BIN)/python -m pip install -qq --constraint constraints.txt torch; \
	UV_COMPILE_BYTECODE=1 $(BIN)/uv pip install --quiet --python $(BIN)/python \
		--constraint constraints.txt --editable '.[dev]' \
		|| $(BIN)/python -m pip install -qq --constraint constraints.txt --editable '.[dev]'; \
	touch $(STAMP)
