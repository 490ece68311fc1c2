# Fuzzing: see fuzz/README.md. Included by Makefile.
.PHONY: fuzz

FUZZ_SECONDS ?= 60

fuzz: setup ## Fuzz the readers, raw arrays, the detector and C calls, FUZZ_SECONDS each
	@fuzz/run.sh $(FUZZ_SECONDS)
