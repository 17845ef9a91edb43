# Wraps what works by hand on any platform: python -m venv .venv; pip install -e '.[models]'; axisrig demo
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
FAST := .venv-fast
FAST_STAMP := $(FAST)/.installed
DOCS_STAMP := $(VENV)/.installed-docs
WHEELHOUSE := wheelhouse
# make wheelhouse fills it once with a network; then every make below works without one
OFFLINE := $(if $(wildcard $(WHEELHOUSE)/*.whl),--no-index --find-links $(WHEELHOUSE))
# A system C compiler is used where there is one; else the extra `cc` brings one from PyPI
comma := ,
EXTRAS := dev$(if $(shell command -v cc 2>/dev/null),,$(comma)cc)
JOBS ?= 2

# UNTIL=UNIX_TIME: of the rest stage, what has not begun by then is skipped and counted
TESTS := -m pytest -q -n $(JOBS) --dist worksteal
PYTEST := $(BIN)/python $(TESTS)
BY_COMPILED := tests/bus tests/distance tests/machine tests/stepping tests/study tests/tools

# Every process that a test starts would compile the package again; threads of small matrices wait
# for each other and burn the time of the others
test test-rest: export PYTHONDONTWRITEBYTECODE :=
test test-rest: export OPENBLAS_NUM_THREADS := 1

.PHONY: demo demo-all test test-rest test-all lint docs sample-report fast wheel wheelhouse clean needs

demo: $(STAMP)
	@$(BIN)/axisrig demo --fresh -j $(JOBS)

demo-all: $(STAMP)
	@$(BIN)/axisrig demo --all --fresh -j $(JOBS)

test: $(STAMP) lint
	@$(PYTEST) --stage quick tests testplans

# Rows of testplans run in tests/compiled, by both builds; whole machines by the compiled one
test-rest: $(STAMP) $(FAST_STAMP)
	@$(PYTEST) --stage rest $(addprefix --until ,$(UNTIL)) --by-compiled "$(BY_COMPILED)" tests
	@$(FAST)/bin/python $(TESTS) --stage all $(addprefix --until ,$(UNTIL)) $(BY_COMPILED)

test-all: test test-rest

lint: $(STAMP)
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@MYPY_NUM_WORKERS=$(JOBS) $(BIN)/mypy

docs: $(DOCS_STAMP)
	@rm -rf out/site out/site-cache
	@$(BIN)/python -m sphinx -W --keep-going -q -b html -d out/site-cache -c docs/site . out/site
	@echo "out/site/index.html"

# One row fails on purpose, so the exit code is 1
sample-report: $(STAMP)
	@$(BIN)/axisrig run docs/sample-report/sample.csv -o out/sample --fresh || test $$? -eq 1
	@cp out/sample/report.html docs/sample-report/report.html

needs:
	@command -v git >/dev/null || { echo "git is missing: apt-get install git"; exit 1; }
	@command -v $(PYTHON) >/dev/null || { echo "$(PYTHON) is missing: apt-get install python3 python3-venv"; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "Python 3.11 or newer is needed, $(PYTHON) is $$($(PYTHON) -V)"; exit 1; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || { echo "the venv module is missing: apt-get install python3-venv"; exit 1; }

$(STAMP): pyproject.toml | needs
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@echo "installing into $(VENV) (once)"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check $(OFFLINE) hatchling editables 'setuptools<81' wheel
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check $(OFFLINE) --no-build-isolation -e '.[$(EXTRAS)]'
	@$(BIN)/python -m compileall -q -j 0 kernel bench fmus reports  # pip does it for what it copies
	@touch $(STAMP)

$(DOCS_STAMP): $(STAMP)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check $(OFFLINE) --no-build-isolation -e '.[docs]'
	@touch $(DOCS_STAMP)

# The same commands, compiled: .venv-fast/bin/axisrig. Not editable: a change is compiled anew
fast: $(FAST_STAMP)

$(FAST_STAMP): $(STAMP) kernel/compile_hook.py $(shell find kernel bench fmus reports -path '*/axisrig/*' -type f ! -name '*.pyc')
	@test -x $(FAST)/bin/python || $(PYTHON) -m venv $(FAST)
	@rm -rf out/wheel; mkdir -p out
	@echo "compiling into $(FAST) (some minutes)"
	@AXISRIG_COMPILE=1 $(BIN)/python -m hatchling build -t wheel -d out/wheel >out/compiled.log 2>&1 || { tail -n 30 out/compiled.log; exit 1; }
	@$(FAST)/bin/python -m pip install --quiet --no-compile --disable-pip-version-check $(OFFLINE) "$$(ls $(CURDIR)/out/wheel/*.whl)[$(EXTRAS)]"
	@$(FAST)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --force-reinstall out/wheel/*.whl
	@touch $(FAST_STAMP)

# For others: compiled, with the FMUs of all models inside, for every Linux with glibc 2.28
wheel: $(STAMP)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check $(OFFLINE) --no-build-isolation -e '.[dev,cc]' auditwheel
	@rm -rf out/dist; mkdir -p out
	@AXISRIG_COMPILE=1 AXISRIG_SHIP=1 $(BIN)/python -m hatchling build -t wheel -d out/dist >out/wheel.log 2>&1 || { tail -n 30 out/wheel.log; exit 1; }
	@$(BIN)/python -m auditwheel show out/dist/*.whl

wheelhouse: | needs
	@$(PYTHON) -m pip download --quiet --disable-pip-version-check -d $(WHEELHOUSE) hatchling editables 'setuptools<81' wheel '.[dev,cc,docs]'
	@echo "$(WHEELHOUSE): $$(ls $(WHEELHOUSE) | wc -l) files; copy the checkout with this folder, then make demo needs no network"

clean:
	rm -rf $(VENV) $(FAST) out
