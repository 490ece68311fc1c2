"""Archives whose bytes follow from their content alone: names in order, one time, no owner."""

from __future__ import annotations

import gzip
import hashlib
import io
import tarfile
import zipfile
from datetime import datetime, timezone
from pathlib import Path

from cargo import commit_time


def _paths(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.is_symlink() or path.is_file())


def _mode(path: Path) -> int:
    return 0o755 if path.stat().st_mode & 0o100 else 0o644


def tar(folder: Path, output: Path) -> None:
    """Packs a folder, its name included, as .tar.gz."""
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w", format=tarfile.GNU_FORMAT) as archive:
        for path in _paths(folder):
            member = archive.gettarinfo(path, str(path.relative_to(folder.parent)))
            member.uid = member.gid = 0
            member.uname = member.gname = ""
            member.mtime = commit_time()
            if member.issym():
                archive.addfile(member)
                continue
            # Files with several names are packed as often.
            member.type, member.size, member.mode = tarfile.REGTYPE, path.stat().st_size, _mode(path)
            with path.open("rb") as content:
                archive.addfile(member, content)
    output.write_bytes(gzip.compress(packed.getvalue(), mtime=commit_time()))


def _member(name: str, mode: int) -> zipfile.ZipInfo:
    time = datetime.fromtimestamp(commit_time(), timezone.utc)
    member = zipfile.ZipInfo(name, time.timetuple()[:6])
    member.compress_type = zipfile.ZIP_DEFLATED
    member.create_system, member.external_attr = 3, (0o100000 | mode) << 16
    return member


def zip(folder: Path, output: Path) -> None:
    """Packs a folder, its name included, as .zip."""
    with zipfile.ZipFile(output, "w") as archive:
        for path in _paths(folder):
            archive.writestr(_member(str(path.relative_to(folder.parent)), _mode(path)), path.read_bytes())


def zip_again(source: Path, output: Path) -> None:
    """Copies a zip that another tool packed, in an order and with a time of ours; what describes a wheel stands last."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(output, "w") as new:
        for info in sorted(old.infolist(), key=lambda info: (".dist-info/" in info.filename, info.filename)):
            if not info.is_dir():
                mode = 0o755 if info.external_attr >> 16 & 0o100 else 0o644
                new.writestr(_member(info.filename, mode), old.read(info), compresslevel=9)


def write_sums(folder: Path) -> None:
    """SHA256SUMS of the files in a folder, as sha256sum reads it."""
    files = sorted(path for path in folder.iterdir() if path.is_file() and path.name != "SHA256SUMS")
    lines = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in files]
    (folder / "SHA256SUMS").write_text("".join(lines))
