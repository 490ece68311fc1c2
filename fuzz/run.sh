#!/usr/bin/env bash
# Runs each fuzz target for a while on the stable toolchain, from the corpus of tests/data/bad and fuzz/corpus.
# usage: fuzz/run.sh [SECONDS [TARGET...]]
# libFuzzer finds its way by coverage counters, which stable compilers can insert; AddressSanitizer, which they
# cannot, is left out here: the readers and the pipeline are safe Rust, and the C programs run under it in ctest.
set -euo pipefail
cd "$(dirname "$0")"

SECONDS_EACH=${1:-60}
# An input that takes longer than this is a finding; generous, since the machines that run this are noisy.
SECONDS_PER_INPUT=30
shift || true
TARGETS=("$@")
[ ${#TARGETS[@]} != 0 ] || TARGETS=(read_ply read_obj read_off read_stl read_gltf arrays detector c_calls)
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-../target}/fuzz
export RUSTC_WRAPPER=$PWD/with_counters.sh

cargo build --release --locked
for target in "${TARGETS[@]}"; do
    found=../build/fuzz/$target
    mkdir -p "$found/corpus" "$found/seeds" "corpus/$target"
    case $target in
    read_gltf) cp ../tests/data/bad/*.gl* "$found/seeds/" ;;
    read_*) cp ../tests/data/bad/*."${target#read_}" "$found/seeds/" ;;
    esac
    echo "fuzz: $target for $SECONDS_EACH s"
    if ! "$CARGO_TARGET_DIR/release/$target" -seed=1 -max_total_time="$SECONDS_EACH" \
        -timeout="$SECONDS_PER_INPUT" -rss_limit_mb=2048 -max_len=65536 -print_final_stats=1 -artifact_prefix="$found/" "$found/corpus" "$found/seeds" \
        "corpus/$target" >"$found/log" 2>&1; then
        tail -n 60 "$found/log" >&2
        echo "fuzz: $target failed; its input is in build/fuzz/$target. Add it to tests/data/bad or fuzz/corpus." >&2
        exit 1
    fi
    grep -E "number_of_executed_units|new_units_added" "$found/log"
done
