# The Blender extension: zip and tests. Included by Makefile.
.PHONY: blender-extension test-blender

# Another Blender: make test-blender BPY=5.0.1
BPY ?= 4.5.15
BLENDER_VENV = build/blender-venv-$(BPY)
export BLENDER_PYTHON ?= python3.11

$(BLENDER_VENV)/.ready: blender_addon/requirements-test.txt
	@scripts/setup.sh blender
	$(BLENDER_PYTHON) -m venv $(BLENDER_VENV)
	$(BLENDER_VENV)/bin/python -m pip install --quiet --disable-pip-version-check \
	    bpy==$(BPY) -r blender_addon/requirements-test.txt
	touch $@

blender-extension: wheel $(BLENDER_VENV)/.ready ## Build the Blender extension with the wheel inside: out/blender
	$(BLENDER_VENV)/bin/python blender_addon/build_extension.py out/wheels/intrinsym-*.whl out/blender

test-blender: blender-extension ## Test the extension, installed into a Blender of its own
	$(BLENDER_VENV)/bin/python -m pytest -q blender_addon/tests
