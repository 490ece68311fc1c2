# The sign network from nothing: virtual environment, data, training, export, figures. Included by Makefile.
.PHONY: train train-test train-setup train-evaluate design-table

TRAIN_OUT ?= build/training
TRAIN_SHAPES ?= 6000
TRAIN_STEPS ?= 14000
TRAIN_SEED ?= 1
PYTHON ?= python3
TRAIN_PYTHON = $(TRAIN_OUT)/venv/bin/python
# One thread each: the two workers below fill two cores, and results do not depend on the number of cores.
TRAIN_ENVIRONMENT = OMP_NUM_THREADS=1 PYTHONHASHSEED=0

# The library inside the onnxruntime wheel, for models of one's own.
ONNX_RUNTIME = $(abspath $(TRAIN_OUT))/venv/lib/python3*/site-packages/onnxruntime/capi/libonnxruntime.so.*

train-setup: $(TRAIN_OUT)/venv/.ready

$(TRAIN_OUT)/venv/.ready: training/requirements.txt training/requirements-data.txt evaluation/requirements.txt
	$(PYTHON) -m venv $(TRAIN_OUT)/venv
	$(TRAIN_PYTHON) -m pip install --quiet -r training/requirements.txt -r evaluation/requirements.txt
	$(TRAIN_PYTHON) -m pip install --quiet --no-deps -r training/requirements-data.txt
	touch $@

$(TRAIN_OUT)/data.ready: $(TRAIN_OUT)/venv/.ready
	cargo build --release --locked --bin intrinsym
	$(TRAIN_ENVIRONMENT) $(TRAIN_PYTHON) -m training.dataset --count $(TRAIN_SHAPES) --seed $(TRAIN_SEED)001 --jobs 2 --out $(TRAIN_OUT)/train.npz
	$(TRAIN_ENVIRONMENT) $(TRAIN_PYTHON) -m training.dataset --count 300 --seed $(TRAIN_SEED)002 --jobs 2 --out $(TRAIN_OUT)/calibration.npz
	$(TRAIN_ENVIRONMENT) $(TRAIN_PYTHON) -m training.dataset --count 700 --seed $(TRAIN_SEED)003 --jobs 2 --out $(TRAIN_OUT)/test.npz
	touch $@

train: $(TRAIN_OUT)/data.ready ## Make the sign network from nothing (under 30 minutes on two cores)
	$(TRAIN_ENVIRONMENT) $(TRAIN_PYTHON) -m training.train --data $(TRAIN_OUT)/train.npz --calibration $(TRAIN_OUT)/calibration.npz --steps $(TRAIN_STEPS) --out $(TRAIN_OUT)/signnet.npz
	$(TRAIN_ENVIRONMENT) $(TRAIN_PYTHON) -m training.export $(TRAIN_OUT)/signnet.npz models/signnet.onnx
	$(TRAIN_ENVIRONMENT) $(TRAIN_PYTHON) -m training.evaluate models/signnet.onnx --data $(TRAIN_OUT)/test.npz

train-evaluate: $(TRAIN_OUT)/venv/.ready ## Measure the shipped sign network on the public benchmark at $$SCB_DATA, SHREC'07 at $$WATERTIGHT_DATA, the authors' labels at $$AUTHORS_LABELS (those that are set)
	$(TRAIN_ENVIRONMENT) $(TRAIN_PYTHON) -m training.evaluate models/signnet.onnx --cache $(TRAIN_OUT)/benchmark \
		$${SCB_DATA:+--benchmark "$$SCB_DATA"} $${WATERTIGHT_DATA:+--watertight "$$WATERTIGHT_DATA"} $${AUTHORS_LABELS:+--authors "$$AUTHORS_LABELS"}

train-test: $(TRAIN_OUT)/venv/.ready ## Test training (a tiny run, no downloads beyond the environment) and evaluation, and models of one's own
	cargo build --release --locked --bin intrinsym
	ORT_DYLIB_PATH=$$(echo $(ONNX_RUNTIME)) cargo test --release --locked --test sign_network -- --ignored
	$(TRAIN_ENVIRONMENT) $(TRAIN_PYTHON) -m pytest -q training/tests evaluation/tests

design-table: $(TRAIN_OUT)/data.ready ## Train and measure the designs that the paper compares
	$(TRAIN_ENVIRONMENT) $(TRAIN_PYTHON) -m training.design_table --folder $(TRAIN_OUT) --out $(TRAIN_OUT)/design_table.md
