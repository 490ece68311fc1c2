# The files of a release for every system, their checks, and the tests of other systems' builds. Included by Makefile.
.PHONY: release release-tools release-check test-windows test-arm deb

RELEASE_VENV = build/release-venv
RELEASE_PYTHON = PATH="$(abspath $(RELEASE_VENV))/bin:$$PATH" $(abspath $(RELEASE_VENV))/bin/python
RELEASE_BLENDER = $(BLENDER_VENV)-$(firstword $(BPY))

# Targets to build; empty: all.
TARGETS ?=

$(RELEASE_VENV)/.ready: release/requirements.txt
	python3 -m venv $(RELEASE_VENV)
	$(RELEASE_VENV)/bin/python -m pip install --quiet --disable-pip-version-check -r release/requirements.txt
	touch $@

release-tools:
	@scripts/setup.sh release
	@$(MAKE) --no-print-directory $(RELEASE_VENV)/.ready

release: release-tools ## Build the files of a release for every system: out/release (TARGETS="linux-x86_64 ..." for some)
	-@$(MAKE) --no-print-directory $(RELEASE_BLENDER)/.ready
	BLENDER_PYTHON_WITH_BPY=$$(ls $(abspath $(RELEASE_BLENDER))/bin/python) $(RELEASE_PYTHON) release/make_release.py $(TARGETS)
	@$(MAKE) --no-print-directory release-check

release-check: release-tools ## Unpack each archive of out/release, inspect it, run its first commands
	$(RELEASE_PYTHON) release/check.py
	$(RELEASE_PYTHON) -m twine check --strict out/release/*.whl

test-windows: release-tools ## Test the Windows build under Wine: C programs, command line, maps as on Linux
	$(RELEASE_PYTHON) release/make_release.py --only-build linux-x86_64 windows-x86_64
	$(RELEASE_PYTHON) -m pytest -q release/tests/test_windows.py

test-arm: release-tools ## Test the build for 64-bit Arm under qemu: C programs, maps near to Linux's on x86-64
	$(RELEASE_PYTHON) release/make_release.py --only-build linux-x86_64 linux-aarch64
	$(RELEASE_PYTHON) -m pytest -q release/tests/test_arm.py

deb: release-tools ## Pack the command line of out/release as a Debian package
	$(RELEASE_PYTHON) release/deb.py
