# The Blender extension: zip and tests. Included by Makefile.
.PHONY: blender-extension test-blender

# Versions of Blender to test in; the zip is built by the first one's tool, and is the same for all.
BPY ?= 4.5.15 5.0.1
BLENDER_VENV = build/blender-venv
.PRECIOUS: $(BLENDER_VENV)-%/.ready
export BLENDER_PYTHON ?= python3.11

$(BLENDER_VENV)-%/.ready: blender_addon/requirements-test.txt
	@scripts/setup.sh blender
	$(BLENDER_PYTHON) -m venv $(BLENDER_VENV)-$*
	$(BLENDER_VENV)-$*/bin/python -m pip install --quiet --disable-pip-version-check \
	    bpy==$* -r blender_addon/requirements-test.txt
	touch $@

blender-extension: wheel $(BLENDER_VENV)-$(firstword $(BPY))/.ready ## Build the Blender extension with the wheel inside: out/blender
	$(BLENDER_VENV)-$(firstword $(BPY))/bin/python blender_addon/build_extension.py out/wheels/intrinsym-*.whl out/blender

test-blender: $(addprefix test-blender-,$(BPY)) ## Test the extension, installed into Blenders of its own (BPY=5.0.1: in one)

test-blender-%: blender-extension $(BLENDER_VENV)-%/.ready
	$(BLENDER_VENV)-$*/bin/python -m pytest -q blender_addon/tests
