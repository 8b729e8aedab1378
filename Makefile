# The commands a person types. Each sets up what it needs first and skips what is there; `make` alone lists them.

PIO     := .venv/bin/pio
PYTHON  := .venv/bin/python
TILENCA := .venv/bin/tilenca
# A program of tools/: $(TOOL) bench.kernel
TOOL    := PYTHONPATH=tools $(PYTHON) -m
# Tests wait for serial lines and browsers half of their time: one more of them than there are processors.
WORKERS ?= $(shell echo $$(($$(nproc) + 1)))
ENV     := megaatmega2560
# Makes the emulator faster on an image, in the background; nothing waits for it.
TRANSLATE := $(PYTHON) -P -m tilenca.emulator.translator --background
ELF     := .pio/build/$(ENV)/firmware.elf

# C++ that is written by hand; what `tilenca export` generates has its own check.
CPP = $(shell find firmware tools test web '(' -name '*.h' -o -name '*.cpp' ')' -not -path '*/model/*' -not -path 'test/vectors/*')

# Buffers are left uninitialised on purpose; the other suppression is for a false alarm on nested `?:`.
CPPCHECK := cppcheck --quiet --error-exitcode=1 --inline-suppr --language=c++ \
	--enable=warning,performance,portability --suppress=uninitMemberVar --suppress=compareBoolExpressionWithInt

# A core directory of the user's own would hide the one of the set-up.
unexport PLATFORMIO_CORE_DIR

# Where this is set, every process of the many that tests start would compile the package again.
unexport PYTHONDONTWRITEBYTECODE

.NOTPARALLEL:
.DEFAULT_GOAL := help
.PHONY: help setup setup-demo setup-train setup-test setup-check setup-docs setup-web setup-fuzz demo test test-web check static format-check lint \
	imports types budgets sanitize docs format train bench sweep soak fuzz report web page-bundle wheel clean

help: ## list these targets
	@echo "make TARGET, where TARGET is one of"
	@sed -n 's/^\([a-z-]*\):[^#]*## /  \1\t/p' $(MAKEFILE_LIST) | expand -t 16

setup: setup-demo ## make this clone ready: system packages, .venv, C++ libraries, PlatformIO

setup-train: ## the same, with PyTorch for training
setup-demo setup-train setup-test setup-check setup-docs setup-web setup-fuzz:
	@sh tools/setup/setup.sh $(@:setup-%=%) $(if $(filter setup%,$(MAKECMDGOALS)),--next)

demo: setup-demo ## build the firmware and let emulated tiles name the ten digits
	@$(PIO) run -e $(ENV)
	@$(TRANSLATE) $(ELF) >/dev/null 2>&1 </dev/null &
	@$(TILENCA) emulate --shape all
	@echo "Next: . .venv/bin/activate && tilenca emulate --shape 4 --watch --seconds 10"

test: setup-test ## run every test: the firmware's core on this machine, then host, emulator and wheel
	@$(PIO) run -s -e $(ENV)
	@$(TRANSLATE) $(ELF) >/dev/null 2>&1 </dev/null &
	@$(TOOL) release.wheel >&2
	@$(PIO) test -e native
	@$(PYTHON) -m pytest -n $(WORKERS) --dist worksteal

web: setup-web ## build the emulator and the simulator for browsers, into build/web/bundle; needs emscripten
	@$(PIO) run -s -e $(ENV)
	@$(TOOL) setup.web
	@$(TOOL) release.web_model models/digits build/web/bundle/digits.json

page-bundle: web ## lay out the page that needs no server of its own, into build/page-bundle
	@$(TOOL) release.page_bundle build/web/bundle build/page-bundle all

test-web: web setup-test ## build for browsers, and run the tests of that
	@$(PYTHON) -m pytest -n 0 test/web test/browser/test_static_bundle.py

check: static test ## what to run before every commit: format, lint, imports, types, budgets, documentation, tests

static: format-check lint imports types budgets docs ## everything of `make check` but the tests

format-check: setup-check
	@.venv/bin/ruff format --check
	@.venv/bin/clang-format --dry-run -Werror $(CPP)

lint: setup-check
	@.venv/bin/ruff check
	@$(CPPCHECK) --std=c++14 -I firmware/include firmware/src/core firmware/src/app
	@$(CPPCHECK) --std=c++17 -I tools -I tools/emulator/src -I firmware/include $(patsubst %,-I %,$(wildcard tools/*/include)) \
		tools/c_api tools/emulator tools/simulator tools/rollout_kernel
	@PLATFORMIO_BUILD_DIR=build/strict PLATFORMIO_BUILD_SRC_FLAGS=-Werror $(PIO) run -s -e $(ENV) -e board_test

imports: setup-check ## check which room may import from which
	@.venv/bin/lint-imports --no-logo

types: setup-check
	@.venv/bin/mypy
	@$(TOOL) page.check

budgets: setup-check ## compare flash, SRAM, stack and cycles of the firmware with tools/firmware/budgets.toml
	@$(PIO) run -s -e $(ENV)
	@$(TILENCA) export --check
	@$(TOOL) firmware.budgets $(ELF)

sanitize: setup-test ## run tests of the C++ libraries with sanitizers for memory and undefined behaviour
	@sh tools/c_api/sanitize.sh

docs: setup-docs ## build the documentation site into build/docs; warnings and broken links are errors
	@.venv/bin/sphinx-build -q -E -n -W --keep-going -c tools/docs -d build/docs/.doctrees . build/docs
	@$(PYTHON) tools/docs/links.py build/docs
	@echo "build/docs/index.html"

format: setup-check ## format all Python and C++
	@.venv/bin/ruff format
	@.venv/bin/clang-format -i $(CPP)

train: setup-train ## train a model of the digits into build/models/digits
	@$(TILENCA) train --shapes shapes/digits.toml --out build/models/digits

bench: setup-train setup-test ## print what the firmware costs and how fast everything is, into docs/BENCHMARKS.md, beside the last run
	@$(PIO) run -s -e $(ENV)
	@rm -f build/bench/figures.jsonl
	@$(TOOL) bench.overview $(ELF)
	@$(TOOL) bench.links $(ELF) --write docs/BENCHMARKS.md
	@$(TOOL) bench.currents --write docs/HARDWARE.md
	@$(TOOL) bench.margins --write docs/HARDWARE.md
	@$(TOOL) bench.training
	@$(TOOL) bench.kernel --write docs/BENCHMARKS.md
	@$(TOOL) bench.fleet
	@$(TOOL) bench.emulator --write docs/BENCHMARKS.md
	@$(TOOL) bench.web --write docs/BENCHMARKS.md
	@$(TOOL) bench.page --write docs/BENCHMARKS.md
	@$(TOOL) bench.sweep --write docs/SWEEPS.md
	@$(TOOL) bench.history

sweep: setup-train ## measure dead tiles and lost messages at three sizes, into docs/SWEEPS.md
	@$(TILENCA) sweep --axis loss=0:0.6:0.1 --axis dead=0,0.02,0.05,0.1,0.2 --axis size=drawn,7x6,12x10 --runs 100 \
		--plot --json --out build/sweep >/dev/null
	@$(TOOL) bench.sweep --table build/sweep --write docs/SWEEPS.md

report: setup-train ## measure every claim again (some fifteen minutes of two cores), into docs/RESULTS.md and docs/results.html
	@$(PIO) run -s -e $(ENV)
	@$(TILENCA) export --model digits-drawn --build
	@$(TILENCA) report --out build/report
	@sed 's/`report.html`/[results.html](results.html)/' build/report/RESULTS.md > docs/RESULTS.md
	@cp build/report/report.html docs/results.html
	@rm -f docs/images/results-*.svg
	@cp build/report/images/results-*.svg docs/images/
	@$(TOOL) docs.claims

TIME ?= 600
soak: setup-test ## let twenty emulated tiles go through everything that can happen, for TIME=600 seconds of theirs; WRITE=FILE
	@$(PIO) run -s -e $(ENV)
	@$(TOOL) bench.ordeal --seconds $(TIME) $(if $(WRITE),--write $(WRITE))

fuzz: setup-fuzz ## fuzz what parses in firmware and emulator, for TIME=600 seconds; needs clang
	@$(TOOL) fuzz --seconds $(TIME)

wheel: setup-test ## build the source archive and the wheel into dist/, with the firmware of the shipped digits
	@$(PIO) run -s -e $(ENV)
	@$(TOOL) release.wheel

clean: ## remove what was built; .venv and PlatformIO's packages stay
	@rm -rf .pio dist build/release build/debug build/sanitize build/strict build/test build/models build/docs build/wheel build/web build/page-bundle
	@rm -rf .mypy_cache .pytest_cache .ruff_cache .hypothesis
