"""What inputs stand for."""

from __future__ import annotations

from pathlib import Path

import pytest

from intrinsym.ray._inputs import find_meshes, place_of

FILES = ("a.ply", "b.OFF", "notes.md", "scene.gltf", "deep/c.obj", "deep/er/d.stl", "deep/e[1].ply", "deep/er/f.GLB", "out/maps/a.ply")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in FILES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(name)
    return tmp_path


def names(folder: Path, *inputs: str, **arguments) -> list[str]:
    return [mesh.place.path.removeprefix(f"{folder}/") for mesh in find_meshes(inputs, **arguments)]


@pytest.mark.parametrize(
    ("pattern", "expected"),
    [
        ("*.ply", ["a.ply"]),
        ("?.*", ["a.ply", "b.OFF"]),
        ("deep/*", ["deep/c.obj", "deep/e[1].ply"]),
        ("deep/**", ["deep/c.obj", "deep/e[1].ply", "deep/er/d.stl", "deep/er/f.GLB"]),
        ("**/*.stl", ["deep/er/d.stl"]),
        ("**/a.ply", ["a.ply", "out/maps/a.ply"]),
        ("[ab].*", ["a.ply", "b.OFF"]),
    ],
)
def test_patterns(folder, pattern, expected):
    assert names(folder, f"{folder}/{pattern}") == expected
    assert names(folder, f"file://{folder}/{pattern}") == expected or "?" in pattern


def test_patterns_and_files_are_relative_to_the_current_folder(folder, monkeypatch):
    monkeypatch.chdir(folder)
    assert names(folder, "*.ply", "deep/c.obj", "./a.ply") == ["a.ply", "deep/c.obj"]


def test_a_folder_stands_for_all_in_it_but_the_results(folder):
    every = ["a.ply", "b.OFF", "deep/c.obj", "deep/e[1].ply", "deep/er/d.stl", "deep/er/f.GLB"]
    assert names(folder, str(folder), without=place_of(f"{folder}/out")) == every
    assert "out/maps/a.ply" in names(folder, str(folder))


def test_a_list_holds_paths_and_uris_and_keeps_what_is_missing(folder, monkeypatch):
    monkeypatch.chdir(folder)
    (folder / "list.txt").write_text(f"a.ply\n\nfile://{folder}/deep/er/d.stl\nnone.ply\n{folder}/a.ply\n")
    meshes = find_meshes(["list.txt"])
    assert [mesh.place.name for mesh in meshes] == [
        f"{folder}/{name}" for name in ("a.ply", "deep/er/d.stl", "none.ply")
    ]
    assert [mesh.size for mesh in meshes] == [5, 13, 0]


def test_what_leads_nowhere_is_said(folder):
    with pytest.raises(FileNotFoundError, match="none.ply: no such file or folder"):
        find_meshes([f"{folder}/none.ply"])
    with pytest.raises(ValueError, match="no mesh files"):
        find_meshes([f"{folder}/*.md"])
    with pytest.raises(ValueError, match="nowhere"):
        find_meshes(["nowhere://host/a.ply"])
