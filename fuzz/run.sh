#!/usr/bin/env bash
# Runs each fuzz target for a while on the stable toolchain, from the corpus of tests/data/bad and fuzz/corpus.
# usage: fuzz/run.sh [--address] [SECONDS [TARGET...]]
# --address: under AddressSanitizer, the C++ sources too; the readers run a fifth as fast then.
set -euo pipefail
cd "$(dirname "$0")"

# An input that takes longer than this is a finding; generous, since the machines that run this are noisy.
SECONDS_PER_INPUT=30
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-../target}/fuzz
export RUSTC_WRAPPER=$PWD/with_counters.sh
BUILD=(cargo build --release --locked)
PROGRAMS=$CARGO_TARGET_DIR/release
if [ "${1:-}" = --address ]; then
    shift
    # The compiler has the sanitizer, for those who ask it to be a nightly one. Build scripts hand the flag on to the C++ compiler.
    export RUSTC_BOOTSTRAP=1
    CARGO_TARGET_DIR+=-address
    export RUSTFLAGS="${RUSTFLAGS:-} -Zsanitizer=address"
    # g++ gives static variables of two functions one name, which is taken for two definitions of one variable.
    export ASAN_OPTIONS="detect_odr_violation=0:${ASAN_OPTIONS:-}"
    # With a system named, flags are not those of macros, which the compiler loads.
    SYSTEM=$(rustc -vV | sed -n 's/^host: //p')
    BUILD+=(--target "$SYSTEM")
    PROGRAMS=$CARGO_TARGET_DIR/$SYSTEM/release
    SECONDS_PER_INPUT=120
fi
SECONDS_EACH=${1:-60}
shift || true
TARGETS=("$@")
[ ${#TARGETS[@]} != 0 ] || TARGETS=(read_ply read_obj read_off read_stl read_gltf arrays detector c_calls)

"${BUILD[@]}"
for target in "${TARGETS[@]}"; do
    found=../build/fuzz/$target
    mkdir -p "$found/corpus" "$found/seeds" "corpus/$target"
    case $target in
    read_gltf) cp ../tests/data/bad/*.gl* "$found/seeds/" ;;
    read_*) cp ../tests/data/bad/*."${target#read_}" "$found/seeds/" ;;
    esac
    echo "fuzz: $target for $SECONDS_EACH s"
    if ! "$PROGRAMS/$target" -seed=1 -max_total_time="$SECONDS_EACH" \
        -timeout="$SECONDS_PER_INPUT" -rss_limit_mb=2048 -max_len=65536 -print_final_stats=1 -artifact_prefix="$found/" "$found/corpus" "$found/seeds" \
        "corpus/$target" >"$found/log" 2>&1; then
        tail -n 60 "$found/log" >&2
        echo "fuzz: $target failed; its input is in build/fuzz/$target. Add it to tests/data/bad or fuzz/corpus." >&2
        exit 1
    fi
    grep -E "number_of_executed_units|new_units_added" "$found/log"
done
