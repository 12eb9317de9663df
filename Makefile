# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
# The front door. Everything here runs on a fresh Debian 12 machine; what is missing is installed first.
.DEFAULT_GOAL := help
.PHONY: help setup build test test-asan preview package bench measure table docs lint format clean

help: ## Show this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-10s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

setup: ## Install everything: packages and Python environments
	@scripts/setup.sh

build: ## Build the native module and shadowcore
	@scripts/setup.sh build
	@scripts/build.sh

test: ## Install what is needed and run all tests
	@bash scripts/setup.sh build
	@/usr/bin/python3 scripts/run_tests.py

test-asan: ## Run the core's own tests with address and undefined-behaviour sanitizers
	@scripts/setup.sh build test
	@scripts/test_asan.sh

preview: ## Build, render the studio scene, compare it with Cycles: out/preview/index.html
	@scripts/preview.sh

package: ## Make the extension zip and the zip for Blender before 4.2: out/package/
	@scripts/setup.sh build
	@scripts/build.sh
	@/usr/bin/python3 scripts/package.py

bench: ## Times and errors by the papers' tables: out/bench/ (ARGS="--quick", ARGS="TABLE ...")
	@scripts/setup.sh build bpy45
	@scripts/build.sh
	@/usr/bin/python3 scripts/bench.py $(ARGS)

measure: ## Measure what the README's tables claim (NAMES="accuracy speed ...", all without)
	@scripts/setup.sh build bpy45 blender test
	@scripts/build.sh
	@/usr/bin/python3 scripts/measure.py $(NAMES)

table: ## Make docs/techniques.md anew: measures all techniques
	@scripts/setup.sh build bpy45
	@scripts/build.sh
	@scripts/make_docs.sh table

docs: ## Make docs/techniques.md, docs/comparison.md and all pictures anew
	@scripts/setup.sh build bpy45
	@scripts/build.sh
	@scripts/make_docs.sh

lint: ## Check the style of Python and C++
	@scripts/setup.sh build test
	@"$$(scripts/setup.sh --python tools)" -m ruff check .
	@scripts/format.sh --check

format: ## Lay out C++ and sort imports
	@scripts/setup.sh build test
	@scripts/format.sh
	@"$$(scripts/setup.sh --python tools)" -m ruff check --fix .

clean: ## Remove everything that was built or written
	rm -rf build out
