"""Packs the command line as a Debian package, from what `make release` compiled: out/release/intrinsym_VERSION_ARCHITECTURE.deb

usage: deb.py     DEBFULLNAME and DEBEMAIL name the maintainer, as they do for Debian's own tools. lintian judges the package.
"""

from __future__ import annotations

import email.utils
import gzip
import os
import shutil
from pathlib import Path

import cargo
from archive import write_sums
from crates import components
from link import run, version
from pack import OUT, fresh
from targets import GLIBC, TARGETS, Target

ARCHITECTURES = {"x86_64": "amd64", "aarch64": "arm64"}
SUMMARY = "mirror symmetry of surface meshes in any pose"
DESCRIPTION = """\
 Finds for every point of a surface mesh the point that is its mirror image
 along the surface, whatever the pose and the connectivity: left and right of
 characters, animals and scans. Reads PLY, OBJ, OFF, STL and glTF; writes
 partners, confidences, sides, pair colours and pictures."""
#: Paths below the package's root, and what is put there, of the folder that `make release` leaves.
MANUAL = {
    "completions/intrinsym.bash": "usr/share/bash-completion/completions/intrinsym",
    "completions/_intrinsym": "usr/share/zsh/vendor-completions/_intrinsym",
    "completions/intrinsym.fish": "usr/share/fish/vendor_completions.d/intrinsym.fish",
}


def maintainer() -> str:
    return f"{os.environ.get('DEBFULLNAME', 'The Intrinsym developers')} <{os.environ.get('DEBEMAIL', 'intrinsym@packages.invalid')}>"


def _put(source: Path, target: Path, mode: int = 0o644) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, target)
    target.chmod(mode)


def _put_compressed(text: bytes, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(gzip.compress(text, mtime=cargo.commit_time()))


def _changelog() -> str:
    date = email.utils.formatdate(cargo.commit_time(), usegmt=False)
    return f"intrinsym ({version()}-1) unstable; urgency=medium\n\n  * Release {version()}.\n\n -- {maintainer()}  {date}\n"


def _copyright(target: Target) -> str:
    """Our licences, and those of what is linked, as text for people."""
    linked = "".join(f"\n  {part.name} {part.version}: {part.licence}" for part in components(target))
    return (
        "Intrinsym, copyright 2026 the Intrinsym authors, under the MIT licence below or the Apache License 2.0, as you like.\n"
        "The text of the latter is in /usr/share/common-licenses/Apache-2.0.\n\n"
        f"{(cargo.ROOT / 'LICENSE-MIT').read_text().strip()}\n\n"
        f"Statically linked, with the texts in THIRD_PARTY.txt.gz and THIRD_PARTY_RUST.html.gz beside this file:{linked}\n"
    )


def _documents(target: Target, folder: Path, packed: Path) -> None:
    (folder).mkdir(parents=True)
    (folder / "copyright").write_text(_copyright(target))
    _put_compressed(_changelog().encode(), folder / "changelog.Debian.gz")
    _put_compressed((cargo.ROOT / "CHANGELOG.md").read_bytes(), folder / "changelog.gz")
    for text in packed.glob("THIRD_PARTY*"):
        _put_compressed(text.read_bytes(), folder / f"{text.name}.gz")
    _put(packed / "MODEL_CARD.md", folder / "MODEL_CARD.md")
    _put(packed / "human.ply", folder / "examples" / "human.ply")


def _control(target: Target, root: Path) -> str:
    size = sum(path.stat().st_size for path in root.rglob("*") if path.is_file()) // 1024
    return (
        f"Package: intrinsym\nVersion: {version()}-1\nArchitecture: {ARCHITECTURES[target.machine]}\n"
        f"Maintainer: {maintainer()}\nInstalled-Size: {size}\nDepends: libc6 (>= {GLIBC})\nSection: graphics\nPriority: optional\n"
        f"Description: {SUMMARY}\n{DESCRIPTION}\n"
    )


def package(target: Target) -> Path:
    packed = cargo.WORK / target.name / f"intrinsym-{version()}-{target.name}"
    root = fresh(cargo.WORK / target.name / "deb")
    _put(packed / target.program, root / "usr/bin/intrinsym", 0o755)
    for page in sorted((packed / "man").iterdir()):
        _put_compressed(page.read_bytes(), root / "usr/share/man/man1" / f"{page.name}.gz")
    for source, place in MANUAL.items():
        _put(packed / source, root / place)
    _documents(target, root / "usr/share/doc/intrinsym", packed)
    (root / "DEBIAN").mkdir()
    (root / "DEBIAN" / "control").write_text(_control(target, root))
    sums = cargo.answer("sh", "-c", f"cd {root} && find usr -type f -print0 | sort -z | xargs -0 md5sum")
    (root / "DEBIAN" / "md5sums").write_text(sums + "\n")
    output = OUT / f"intrinsym_{version()}-1_{ARCHITECTURES[target.machine]}.deb"
    run("dpkg-deb", "--root-owner-group", "-Zxz", "--build", root, output, SOURCE_DATE_EPOCH=str(cargo.commit_time()))
    return output


def main() -> None:
    built = [target for target in TARGETS if target.system == "linux" and list(OUT.glob(f"intrinsym-{version()}-{target.name}.tar.gz"))]
    if not built:
        raise SystemExit("deb: no program for Linux is there; make release first")
    packages = [package(target) for target in built]
    write_sums(OUT)
    run("lintian", "--fail-on", "error,warning", "--suppress-tags", "initial-upload-closes-no-bugs", *packages)


if __name__ == "__main__":
    main()
