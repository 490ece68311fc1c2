# Measuring: the published benchmark, generated shapes, damage, and the fits made from generated shapes. Included by Makefile.
.PHONY: evaluate evaluate-stability evaluate-hard evaluate-synthetic evaluate-robustness evaluate-fit evaluate-remeshed evaluate-watertight evaluate-family evaluate-symmetries evaluate-assemblies evaluate-ray ablate test-accuracy record-accuracy

EVALUATE_PYTHON = $(TRAIN_ENVIRONMENT) $(TRAIN_PYTHON) -m
EVALUATE_DATE ?= $(shell date +%Y-%m-%d)
EVALUATE_DATA = build/evaluation
# A quick run is not kept.
EVALUATE_RESULTS = $(if $(filter --quick,$(EVALUATE_FLAGS)),out,docs/results)/$(EVALUATE_DATE)

evaluate: ## Measure maps on the Princeton benchmark at $$BENCHMARK_DATA (SCAPE and TOSCA): the published tables with ours
	@test -d "$$BENCHMARK_DATA/SCAPE" -a -d "$$BENCHMARK_DATA/TOSCA" || { echo "BENCHMARK_DATA must name a folder with SCAPE/ and TOSCA/ of the Princeton correspondence benchmark: see evaluation/princeton.py" >&2; exit 2; }
	@$(MAKE) --no-print-directory train-setup
	cargo build --release --locked --bin intrinsym
	$(EVALUATE_PYTHON) evaluation.princeton "$$BENCHMARK_DATA" --out docs/results/$(EVALUATE_DATE)-princeton.json --pictures out/princeton
	$(EVALUATE_PYTHON) evaluation.pages

evaluate-remeshed: train-setup ## Measure maps and signs on remeshed FAUST and TOSCA at $$REMESHED_DATA
	cargo build --release --locked --bin intrinsym
	$(EVALUATE_PYTHON) evaluation.remeshed "$$REMESHED_DATA" --out docs/results/$(EVALUATE_DATE)-remeshed.json
	$(EVALUATE_PYTHON) evaluation.pages
	$(EVALUATE_PYTHON) training.evaluate models/signnet.onnx --remeshed "$$REMESHED_DATA"

evaluate-watertight: train-setup ## Measure maps of eleven classes of SHREC'07 with landmarks, at $$WATERTIGHT_DATA
	@test -d "$$WATERTIGHT_DATA/Corrs" || { echo "WATERTIGHT_DATA must name a folder with Meshes/ and Corrs/: see evaluation/watertight.py" >&2; exit 2; }
	cargo build --release --locked --bin intrinsym
	$(EVALUATE_PYTHON) evaluation.watertight "$$WATERTIGHT_DATA" --out docs/results/$(EVALUATE_DATE)-watertight.json
	$(EVALUATE_PYTHON) evaluation.pages

evaluate-synthetic: train-setup ## Measure maps, confidence and refusals on generated shapes with dense truth (EVALUATE_FLAGS=--quick: a few)
	cargo build --release --locked --bin intrinsym
	$(EVALUATE_PYTHON) evaluation.synthetic $(EVALUATE_FLAGS) --out $(EVALUATE_RESULTS)-synthetic.json --work $(EVALUATE_DATA)/synthetic
	$(EVALUATE_PYTHON) evaluation.pages

evaluate-robustness: train-setup ## Measure maps, verdicts and confidence on ever worse input (EVALUATE_FLAGS=--quick: two shapes)
	cargo build --release --locked --bin intrinsym
	$(EVALUATE_PYTHON) evaluation.robustness $(EVALUATE_FLAGS) --out $(EVALUATE_RESULTS)-robustness.json --work $(EVALUATE_DATA)/robustness
	$(EVALUATE_PYTHON) evaluation.robustness_tables $(EVALUATE_RESULTS)-robustness.json $(if $(filter --quick,$(EVALUATE_FLAGS)),out,docs)/robustness.png
	$(EVALUATE_PYTHON) evaluation.pages

evaluate-stability: train-setup ## Measure whether the same shape gives the same answer however it is written: docs/robustness.md
	cargo build --release --locked --bin intrinsym
	$(EVALUATE_PYTHON) evaluation.stability --out $(EVALUATE_RESULTS)-stability.json
	$(EVALUATE_PYTHON) evaluation.pages

evaluate-hard: train-setup ## Measure what hubs, fans, combs and soups cost, and how soon a cancel ends them: docs/robustness.md
	cargo build --release --locked -p intrinsym-capi
	INTRINSYM_LIBRARY=$(abspath $(or $(CARGO_TARGET_DIR),target))/release/libintrinsym.so PYTHONPATH=python/src:. $(EVALUATE_PYTHON) evaluation.hard_meshes --out $(EVALUATE_RESULTS)-hard.json
	$(EVALUATE_PYTHON) evaluation.pages

# The shapes that docs/method.md names; `make train-setup` brings the generator.
GENERATE = $(EVALUATE_PYTHON) training.generate $(1) --max-vertices 12000 --out $(EVALUATE_DATA)/$(2)
$(EVALUATE_DATA)/fit.ready: | $(TRAIN_OUT)/venv/.ready
	$(call GENERATE,--kind all --count 160 --seed 45,symmetric)
	$(call GENERATE,--kind all --count 240 --seed 47,symmetric)
	$(call GENERATE,--kind asymmetric-tree --kind unbalanced --count 110 --seed 103,asymmetric)
	$(call GENERATE,--kind asymmetric-tree --kind unbalanced --count 110 --seed 203,asymmetric)
	$(call GENERATE,--kind lump --count 70 --seed 104,asymmetric)
	$(call GENERATE,--kind lump --count 70 --seed 204,asymmetric)
	$(call GENERATE,--kind asymmetric-tree --kind unbalanced --kind lump --count 240 --seed 303 --clean,asymmetric_clean)
	$(call GENERATE,--kind lopsided --count 240 --seed 503,lopsided)
	$(call GENERATE,--kind solid --count 160 --seed 105,solid)
	$(call GENERATE,--kind stout --count 160 --seed 106,stout)
	touch $@

evaluate-fit: $(EVALUATE_DATA)/fit.ready ## Fit the models of src/verify/acceptance.rs and src/verify/confidence.rs again, beside the shipped weights
	cargo build --release --locked --bin intrinsym --example evidence
	rm -rf $(EVALUATE_DATA)/answers $(EVALUATE_DATA)/evidence
	$(EVALUATE_PYTHON) evaluation.acceptance $(addprefix $(EVALUATE_DATA)/,symmetric solid stout asymmetric asymmetric_clean lopsided) --keep $(EVALUATE_DATA)/answers
	$(EVALUATE_PYTHON) evaluation.confidence $(EVALUATE_DATA)/symmetric --answers $(EVALUATE_DATA)/answers --keep $(EVALUATE_DATA)/evidence

evaluate-family: train-setup ## Measure the test for a continuous family (EVALUATE_MESHES: others, which have none)
	cargo build --release --locked --example continuous_family
	$(EVALUATE_PYTHON) evaluation.continuous_family $(EVALUATE_MESHES) --work $(EVALUATE_DATA)/family

evaluate-symmetries: train-setup ## Measure how many symmetries of solids are listed, and how many listed ones are none
	cargo build --release --locked --bin intrinsym
	$(EVALUATE_PYTHON) evaluation.several_symmetries --work $(EVALUATE_DATA)/symmetries

evaluate-assemblies: train-setup ## Measure generated characters, furniture and vehicles of many shells (EVALUATE_ASSEMBLIES: others with truth)
	cargo build --release --locked --bin intrinsym
	$(if $(EVALUATE_ASSEMBLIES),,$(EVALUATE_PYTHON) evaluation.assemblies --write $(EVALUATE_DATA)/assemblies)
	$(EVALUATE_PYTHON) evaluation.assemblies --judge $(or $(EVALUATE_ASSEMBLIES),$(EVALUATE_DATA)/assemblies) --out $(if $(EVALUATE_ASSEMBLIES),out,docs/results)/$(EVALUATE_DATE)-assemblies.json
	$(EVALUATE_PYTHON) evaluation.pages

evaluate-ray: ray-setup train-setup ## Ten thousand small meshes through two nodes of Ray, killed twice and resumed: rows, overhead
	$(RAY_VENV)/bin/python -m evaluation.many_meshes --out docs/results/$(EVALUATE_DATE)-ray.json --work $(EVALUATE_DATA)/ray
	$(EVALUATE_PYTHON) evaluation.pages

ablate: train-setup ## Measure the program with one thing changed at a time: docs/ablation.md (ABLATE_FLAGS=--test: the test sets, too)
	cargo build --release --locked --bin intrinsym --example ablate
	$(EVALUATE_PYTHON) evaluation.ablate $(ABLATE_FLAGS) --out docs/results/$(EVALUATE_DATE)-ablation.json --work $(EVALUATE_DATA)/ablation
	$(EVALUATE_PYTHON) evaluation.pages

test-accuracy: train-setup ## Compare maps of twenty generated shapes with the errors recorded in evaluation/accuracy.json
	cargo build --release --locked --bin intrinsym
	$(EVALUATE_PYTHON) evaluation.accuracy

record-accuracy: train-setup ## Record these errors anew, after a change of results on purpose
	cargo build --release --locked --bin intrinsym
	$(EVALUATE_PYTHON) evaluation.accuracy --record
