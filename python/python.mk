# The Python package: wheel and tests. Included by Makefile.
.PHONY: wheel test-python test-ray ray-setup

PYTHON_VENV = build/python-venv
RAY_VENV = build/ray-venv

$(PYTHON_VENV)/.ready: python/requirements-test.txt
	@scripts/setup.sh python
	python3 -m venv $(PYTHON_VENV)
	$(PYTHON_VENV)/bin/python -m pip install --quiet --disable-pip-version-check -r python/requirements-test.txt
	touch $@

wheel: $(PYTHON_VENV)/.ready ## Build the Python wheel with the library inside: out/wheels
	@scripts/make_wheel.sh $(abspath $(PYTHON_VENV))/bin/python

test-python: wheel ## Test the wheel, installed into a clean virtual environment
	cargo build --release --locked --bin intrinsym
	$(PYTHON_VENV)/bin/python -m pip install --quiet --no-deps --force-reinstall out/wheels/intrinsym-*.whl
	$(PYTHON_VENV)/bin/python -m pytest -q python/tests

# Ray needs Python 3.10 or newer.
$(RAY_VENV)/.ready: python/requirements-ray.txt
	@scripts/setup.sh python
	python3 -m venv $(RAY_VENV)
	$(RAY_VENV)/bin/python -m pip install --quiet --disable-pip-version-check -r python/requirements-ray.txt
	touch $@

ray-setup: wheel $(RAY_VENV)/.ready
	cargo build --release --locked --bin intrinsym
	$(RAY_VENV)/bin/python -m pip install --quiet --no-deps --force-reinstall out/wheels/intrinsym-*.whl

RAY_FLAGS ?=

test-ray: ray-setup ## Test the wheel on Ray: a cluster of two nodes on this machine, of which some are killed
	$(RAY_VENV)/bin/python -m pytest -q python/tests_ray $(RAY_FLAGS)
