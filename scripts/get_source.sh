#!/usr/bin/env bash
# Gets the upstream source of a Debian package from the archive that this machine's apt uses, through an apt state
# of its own: the system's sources stay as they are, and root is not needed.
# usage: get_source.sh PACKAGE FOLDER SUITE...   (the first suite that has it counts)
# SOURCE_SHA256, if set, is what the archive file must have. DEBIAN_MIRROR overrides the machine's archive.
set -euo pipefail

PACKAGE=$1
FOLDER=$2
shift 2
KEYRING=/usr/share/keyrings/debian-archive-keyring.gpg

fail() {
    echo "get_source: $1" >&2
    exit 1
}

# Debian's main archive as apt knows it, such as scheme://host/debian.
mirror() {
    apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' |
        awk '$1 == "Debian" && $2 !~ /security/ { print $2; exit }'
}

download_from() {
    local suite=$1 state=$SCRATCH/$1
    mkdir -p "$state/lists/partial" "$state/cache/archives/partial"
    : >"$state/status"
    echo "deb-src [signed-by=$KEYRING] $DEBIAN_MIRROR $suite main" >"$state/sources.list"
    local options=(-qq -o "Dir::Etc::sourcelist=$state/sources.list" -o Dir::Etc::sourceparts=/dev/null
        -o "Dir::State::lists=$state/lists" -o "Dir::Cache=$state/cache" -o "Dir::State::status=$state/status"
        -o Acquire::Languages=none -o Acquire::Retries=3 -o APT::Sandbox::User=)
    apt-get "${options[@]}" update &&
        (cd "$SCRATCH" && apt-get "${options[@]}" source --download-only --tar-only "$PACKAGE")
}

command -v apt-get >/dev/null || fail "this is no Debian; please unpack the source of $PACKAGE yourself"
[ -f "$KEYRING" ] || fail "$KEYRING is missing (package debian-archive-keyring)"
DEBIAN_MIRROR=${DEBIAN_MIRROR:-$(mirror)}
[ -n "$DEBIAN_MIRROR" ] || fail "apt knows no Debian archive; set DEBIAN_MIRROR"
SCRATCH=$(mktemp -d)
trap 'rm -rf "$SCRATCH"' EXIT

for suite in "$@"; do
    download_from "$suite" || continue
    archive=$(ls "$SCRATCH/$PACKAGE"_*.orig.tar.*)
    if [ -n "${SOURCE_SHA256:-}" ] && ! echo "$SOURCE_SHA256  $archive" | sha256sum --check --status; then
        echo "get_source: $suite has another version: $(basename "$archive")" >&2
        rm "$archive"
        continue
    fi
    rm -rf "$FOLDER"
    mkdir -p "$FOLDER"
    tar -xf "$archive" -C "$FOLDER" --strip-components=1
    exit 0
done
fail "no suite of $* has the wanted source of $PACKAGE"
