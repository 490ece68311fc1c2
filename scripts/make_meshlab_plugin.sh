#!/usr/bin/env bash
# Builds the MeshLab plugin in both precisions and packs it:
# out/meshlab/intrinsym-VERSION-meshlab-MESHLAB-PLATFORM.zip, and its content beside it.
# MESHLAB_SOURCE and OPENMESH_SOURCE name source trees that are there already, INTRINSYM_LIBRARY a static library.
set -euo pipefail
cd "$(dirname "$0")/.."

MESHLAB_VERSION=2025.07
MESHLAB_SHA256=d22c98d362f2a284e481af8dbfc272b2222f5b9c67b3cf8bec57d1c3161886f4
BUILD=build/meshlab
PLUGIN=libfilter_intrinsic_symmetry.so
VERSION=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
NAME=intrinsym-$VERSION-meshlab-$MESHLAB_VERSION-linux-$(uname -m)
LIBRARY=$(realpath -m "${INTRINSYM_LIBRARY:-${CARGO_TARGET_DIR:-target}/release/libintrinsym.a}")

# Sources of a package, once.
source_tree() {
    local package=$1 sha256=$2
    shift 2
    [ -d "$BUILD/$package" ] || SOURCE_SHA256=$sha256 scripts/get_source.sh "$package" "$BUILD/$package" "$@"
    realpath "$BUILD/$package"
}

build() {
    local precision=$1
    cmake -S cpp/meshlab -B "$BUILD/$precision" -DMESHLAB_PRECISION="$precision" \
        -DMESHLAB_SOURCE="$MESHLAB_SOURCE" -DOPENMESH_SOURCE="$OPENMESH_SOURCE" \
        -DINTRINSYM_LIBRARY="$LIBRARY" -DBUILD_TESTING="$([ "$precision" = float ] && echo OFF || echo ON)" >/dev/null
    cmake --build "$BUILD/$precision" --parallel 2 -- -s --no-print-directory
}

# Debug information is most of the library.
stage() {
    local folder=$1 precision=$2
    mkdir -p "out/meshlab/$NAME/$folder"
    strip --strip-unneeded -o "out/meshlab/$NAME/$folder/$PLUGIN" "$BUILD/$precision/$PLUGIN"
}

pack() {
    rm -rf out/meshlab
    stage meshlab float
    stage pymeshlab double
    local folder=out/meshlab/$NAME glibc
    glibc=$(objdump -T "$folder"/*/"$PLUGIN" | grep -o 'GLIBC_2\.[0-9]*' | sort -Vu | tail -n 1)
    sed "s/@VERSION@/$VERSION/; s/@MESHLAB_VERSION@/$MESHLAB_VERSION/; s/@GLIBC@/${glibc#GLIBC_}/" \
        cpp/meshlab/README.txt >"$folder/README.txt"
    cp cpp/meshlab/LICENSE "$folder/LICENSE"
    cp LICENSE "$folder/LICENSE-library"
    cp LICENSE-APACHE LICENSE-MIT models/MODEL_CARD.md "$folder/"
    cp "$OPENMESH_SOURCE/LICENSE" "$folder/LICENSE-OpenMesh"
    (cd out/meshlab && python3 -m zipfile -c "$NAME.zip" "$NAME")
    ls -l out/meshlab/*.zip
}

mkdir -p "$BUILD"
[ -n "${INTRINSYM_LIBRARY:-}" ] || cargo build --release --locked --lib
MESHLAB_SOURCE=${MESHLAB_SOURCE:-$(source_tree meshlab "$MESHLAB_SHA256" sid testing)}
OPENMESH_SOURCE=$(scripts/get_openmesh.sh)
[ "$(cat "$MESHLAB_SOURCE/ML_VERSION")" = "$MESHLAB_VERSION" ]
build double
build float
pack
