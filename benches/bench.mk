# Times and memory by size, beside what a Python user would take instead. Included by Makefile.
.PHONY: bench

BENCH_VENV = out/bench-venv
# Frequencies f of the generated meshes, of 10 f^2 + 2 vertices; the peers run on the first three alone.
BENCH_FREQUENCIES ?= 10 35 71 141 316
BENCH_OUT ?= benches/results/$(shell date +%Y-%m-%d)

$(BENCH_VENV)/.ready: benches/requirements.txt
	python3 -m venv $(BENCH_VENV)
	$(BENCH_VENV)/bin/python -m pip install --quiet -r benches/requirements.txt
	touch $@

bench: setup $(BENCH_VENV)/.ready ## Measure seconds by stage and peak memory, 1k to 1M vertices, beside SciPy
	cargo bench --profile release --locked --bench stages --no-run
	OMP_NUM_THREADS=1 $(BENCH_VENV)/bin/python benches/compare.py --out $(BENCH_OUT) $(BENCH_FREQUENCIES)
