#!/usr/bin/env bash
# Builds a C program against an installed copy as pkg-config says, shared and static, and runs both.
# usage: by_pkg_config.sh CC PREFIX SOURCE ARGUMENT
set -euo pipefail
compiler=$1 prefix=$2 source=$3 argument=$4
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
pc=$(find "$prefix" -name intrinsym.pc)
ask() {
    PKG_CONFIG_PATH=$(dirname "$pc") pkg-config --define-variable=prefix="$prefix" "$@" intrinsym
}
read -ra shared <<<"$(ask --cflags --libs)"
read -ra static <<<"$(ask --static --cflags --libs | sed 's/-lintrinsym/-l:libintrinsym.a/')"
"$compiler" "$source" -o "$folder/shared" "${shared[@]}"
"$compiler" "$source" -o "$folder/static" "${static[@]}"
LD_LIBRARY_PATH=$(ask --variable=libdir) "$folder/shared" "$argument" >"$folder/first"
"$folder/static" "$argument" >"$folder/second"
cmp "$folder/first" "$folder/second"
[ "$(ask --modversion)" = "$(sed -n 's/^#define ISYM_VERSION "\(.*\)"/\1/p' "$prefix/include/isym.h")" ]
if ldd "$folder/static" | grep -q intrinsym; then
    echo "the static program asks for the shared library" >&2
    exit 1
fi
