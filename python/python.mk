# The Python package: wheel and tests. Included by Makefile.
.PHONY: wheel test-python

PYTHON_VENV = build/python-venv

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
