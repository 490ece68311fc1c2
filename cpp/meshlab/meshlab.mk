# The MeshLab plugin: build, package and tests. Included by Makefile.
.PHONY: meshlab-plugin test-meshlab

MESHLAB_VENV = build/meshlab/venv

meshlab-plugin: ## Build the MeshLab plugin, single and double precision: out/meshlab
	@scripts/setup.sh meshlab
	@scripts/make_meshlab_plugin.sh

$(MESHLAB_VENV)/.ready: cpp/meshlab/tests/requirements.txt
	@scripts/setup.sh python
	python3 -m venv $(MESHLAB_VENV)
	$(MESHLAB_VENV)/bin/python -m pip install --quiet --disable-pip-version-check -r cpp/meshlab/tests/requirements.txt
	touch $@

test-meshlab: meshlab-plugin $(MESHLAB_VENV)/.ready ## Test the MeshLab plugin inside PyMeshLab
	cargo build --release --locked --bin intrinsym
	ctest --test-dir build/meshlab/double --output-on-failure
	$(MESHLAB_VENV)/bin/python -m pytest -q cpp/meshlab/tests
