#!/usr/bin/env bash
# Prints the folder of OpenMesh's source, of the version whose headers the library is built with; gets it once.
# OPENMESH_SOURCE names a source tree that is there already.
set -euo pipefail
cd "$(dirname "$0")/.."

FOLDER=${OPENMESH_SOURCE:-$PWD/build/openmesh}
HEADER=OpenMesh/Core/Mesh/PolyConnectivity.hh

[ -d "$FOLDER" ] || scripts/get_source.sh openmesh "$FOLDER" "$(. /etc/os-release && echo "$VERSION_CODENAME")" >&2
if ! cmp -s "$FOLDER/src/$HEADER" "$(pkg-config --variable=includedir openmesh)/$HEADER"; then
    echo "get_openmesh: $FOLDER is not the installed version of OpenMesh" >&2
    exit 1
fi
realpath "$FOLDER"
