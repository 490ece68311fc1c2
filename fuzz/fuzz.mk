# Fuzzing: see fuzz/README.md. Included by Makefile.
.PHONY: fuzz

FUZZ_SECONDS ?= 60
FUZZ_FLAGS ?= --address

fuzz: setup ## Fuzz the readers, raw arrays, the detector and C calls under AddressSanitizer, FUZZ_SECONDS each
	@fuzz/run.sh $(FUZZ_FLAGS) $(FUZZ_SECONDS)
