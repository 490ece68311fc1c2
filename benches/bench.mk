# Times and memory by size, beside what a Python user would take instead, and stage by stage. Included by Makefile.
.PHONY: bench bench-stages bench-page

BENCH_VENV = out/bench-venv
# Frequencies f of the generated meshes, of 10 f^2 + 2 vertices; the peers run on the first three alone.
BENCH_FREQUENCIES ?= 10 35 71 141 316
BENCH_OUT ?= benches/results/$(shell date +%Y-%m-%d)

$(BENCH_VENV)/.ready: benches/requirements.txt
	python3 -m venv $(BENCH_VENV)
	$(BENCH_VENV)/bin/python -m pip install --quiet -r benches/requirements.txt
	touch $@

bench: setup $(BENCH_VENV)/.ready ## Measure seconds and peak memory, 1k to 1M vertices, beside SciPy; then bench-stages
	cargo bench --profile release --locked --features criterion --bench stages --no-run
	OMP_NUM_THREADS=1 $(BENCH_VENV)/bin/python benches/compare.py --out $(BENCH_OUT) $(BENCH_FREQUENCIES)
	@$(MAKE) --no-print-directory bench-stages BENCH_OUT=$(BENCH_OUT)

bench-stages: setup ## Measure each stage by itself (criterion), and how far it is from the floor
	python3 benches/by_stage.py --out $(BENCH_OUT) $(BENCH_FREQUENCIES)

bench-page: ## Put the tables and the curves in BENCH_OUT into docs/speed.md
	python3 benches/page.py $(BENCH_OUT) docs/speed.md
