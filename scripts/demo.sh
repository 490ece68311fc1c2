#!/usr/bin/env bash
# Finds the symmetry of the posed human in examples/ and of real animals and people from Debian's
# libcgal-demo, where that package can be had. Everything is written to out/demo.
set -euo pipefail
cd "$(dirname "$0")/.."

OUT=out/demo
REAL=(man homer camel elephant cow bull)

# Unpacks the meshes of libcgal-demo without installing it: it would bring a graphical toolkit along.
fetch_real_meshes() {
    [ -e "$OUT/meshes/${REAL[-1]}.off" ] && return
    command -v apt-get >/dev/null || return 1
    mkdir -p "$OUT/package"
    (cd "$OUT/package" && apt-get download -qq libcgal-demo 2>/dev/null) || return 1
    dpkg-deb -x "$OUT"/package/libcgal-demo_*.deb "$OUT/package" || return 1
    local archive
    archive=$(find "$OUT/package" -name data.tar.gz -print -quit)
    [ -n "$archive" ] || return 1
    tar -xzf "$archive" -C "$OUT/package" || return 1
    mkdir -p "$OUT/meshes"
    local name
    for name in "${REAL[@]}"; do
        cp "$OUT/package/data/meshes/$name.off" "$OUT/meshes/" || return 1
    done
    rm -r "$OUT/package"
}

# Doubtful (3) and none (1) are answers, too.
detect() {
    local status=0
    "${CARGO_TARGET_DIR:-target}/release/intrinsym" detect "$@" || status=$?
    case $status in 0 | 1 | 3) ;; *) return "$status" ;; esac
}

cargo build --release --locked --bin intrinsym
mkdir -p "$OUT"

echo
echo "A posed human, left arm raised, left knee bent, with eyes, teeth and eyelashes as separate shells:"
detect examples/human_shells.ply -o "$OUT/human.ply" --map "$OUT/human.map" --json "$OUT/human.json" \
    --picture "$OUT/human.png"

echo
if fetch_real_meshes; then
    meshes=("${REAL[@]/%/.off}")
    meshes=("${meshes[@]/#/$OUT/meshes/}")
    echo "Animals and people from Debian's libcgal-demo:"
    detect --output-dir "$OUT" --write ply,map,json,png "${meshes[@]}"
else
    echo "Debian's package libcgal-demo cannot be downloaded here, so the quadruped of examples/ it is:"
    detect --output-dir "$OUT" --write ply,map,json,png examples/quadruped.ply
fi

echo
echo "Pictures, maps and meshes are in $OUT. Look at $OUT/human.png first."
