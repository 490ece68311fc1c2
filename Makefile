# `make demo` and `make test` each set up a fresh Debian or Ubuntu machine by themselves.

.DEFAULT_GOAL := help
.PHONY: help demo test fmt examples clean setup setup-test header check-header check-folders public-api check-public-api test-c mutants mutants-sample

help: ## Say what can be made
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-18s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

setup:
	@scripts/setup.sh

setup-test:
	@scripts/setup.sh nextest

demo: setup ## Build, find the symmetry of a posed human and of real animals, write out/demo
	@scripts/demo.sh

test: setup-test ## Check format and lints, run all tests
	cargo fmt --all --check
	@$(MAKE) --no-print-directory check-header
	cargo clippy --release --locked --all-targets --features criterion -- -D warnings
	# Without the feature `internals` what tests alone use is dead code.
	cargo clippy --release --locked -p intrinsym --lib -- -D warnings
	@$(MAKE) --no-print-directory check-folders
	@$(MAKE) --no-print-directory check-public-api
	cargo test --release --locked --doc --quiet
	cargo nextest run --release --locked
	@$(MAKE) --no-print-directory mutants-sample
	@$(MAKE) --no-print-directory test-c
	@$(MAKE) --no-print-directory fuzz FUZZ_SECONDS=10 FUZZ_FLAGS=
	@$(MAKE) --no-print-directory test-meshlab
	@$(MAKE) --no-print-directory train-test
	@$(MAKE) --no-print-directory test-accuracy
	@$(MAKE) --no-print-directory test-python
	@$(MAKE) --no-print-directory test-ray RAY_FLAGS='-m "not client"'
	@$(MAKE) --no-print-directory test-blender BPY=4.5.15

test-c: ## Test the C library: C and C++ programs under sanitizers, and an installed copy
	cmake -S . -B out/cmake -DCMAKE_BUILD_TYPE=Release
	cmake --build out/cmake
	ctest --test-dir out/cmake --output-on-failure

MUTANTS_SHARD ?=
MUTANTS_FLAGS ?=

# A build directory of its own: nothing that is changed on purpose lies where others build.
mutants: setup-test ## Change the program in one place at a time; a test must fail. MUTANTS_SHARD=k/n: a part (docs/mutants.md)
	@scripts/setup.sh mutants
	@mkdir -p out
	CARGO_TARGET_DIR=$(abspath target/mutants) CARGO_INCREMENTAL=0 cargo mutants --workspace --output out \
		--sharding round-robin $(if $(MUTANTS_SHARD),--shard $(MUTANTS_SHARD)) $(MUTANTS_FLAGS)

# As soon built as can be: unoptimised, and no tests but the folder's own. The same source means the same changes.
mutants-sample: ## Change a few places of src/geometry; a unit test of that folder must fail for each
	@scripts/setup.sh mutants
	@mkdir -p out/mutants-sample
	CARGO_TARGET_DIR=$(abspath target/mutants) CARGO_INCREMENTAL=1 CARGO_PROFILE_DEV_DEBUG=0 cargo mutants --no-config \
		--package intrinsym --file 'src/geometry/**' --sharding round-robin --shard 0/66 --output out/mutants-sample \
		--test-tool nextest --cargo-arg=--locked --cargo-arg=--lib -- geometry::

header: ## Make include/isym.h again from capi/src
	cargo run --quiet --locked --target-dir target/header --manifest-path tools/header/Cargo.toml -- --write

check-header: ## Check that include/isym.h is what capi/src says
	cargo run --quiet --locked --target-dir target/header --manifest-path tools/header/Cargo.toml

check-folders: ## Check that each folder of src/ compiles without those after it
	@scripts/check_folders.sh

# Pages of the library alone: rustdoc's warnings are errors.
DOC = RUSTDOCFLAGS="-D warnings" cargo doc --release --locked --quiet --no-deps -p intrinsym
PUBLIC_API = python3 tools/public_api/check.py $(or $(CARGO_TARGET_DIR),target)/doc/intrinsym

public-api: ## Keep the public names of the Rust library as they are now: tools/public_api/names.txt
	rm -rf $(or $(CARGO_TARGET_DIR),target)/doc
	$(DOC)
	$(PUBLIC_API) --write

check-public-api: ## Check the Rust library's pages, and its public names against the kept listing
	rm -rf $(or $(CARGO_TARGET_DIR),target)/doc
	$(DOC)
	$(PUBLIC_API)

fmt: ## Format the sources
	cargo fmt --all

clean: ## Remove everything that was built or written
	cargo clean
	rm -rf out

include cpp/meshlab/meshlab.mk
include fuzz/fuzz.mk
include python/python.mk
include blender_addon/blender.mk
include training/train.mk
include benches/bench.mk
include evaluation/evaluate.mk
include release/release.mk
