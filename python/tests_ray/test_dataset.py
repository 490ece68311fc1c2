"""detect_dataset on a cluster of two nodes."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pyarrow as pa
import pytest
import ray
from conftest import assert_same_as_command_line, by_name, copy_examples, without_times, write_mesh

import intrinsym
from intrinsym.ray import SCHEMA, detect_dataset
from intrinsym.ray._dataset import BATCH_MESHES, BLOCK_BYTES, BLOCK_MESHES, blocks_of
from intrinsym.ray._inputs import MeshFile, place_of

FAST = {"effort": "fast"}


def test_rows_are_what_the_command_line_says(connected, meshes, command_line):
    examples = copy_examples(meshes)
    paths = sorted(meshes.iterdir())
    rows = rows_of(detect_dataset(str(meshes), FAST))
    assert sorted(row["path"] for row in rows.values()) == [str(path) for path in paths]
    folder = command_line(paths)
    for row in rows.values():
        assert_same_as_command_line(row, folder)
        assert row["content_hash"] == hashlib.sha256(Path(row["path"]).read_bytes()).hexdigest()
        assert row["error"] is None and row["seconds"] > 0
    outcomes = {Path(row["path"]).stem: row["outcome"] for row in rows.values()}
    assert outcomes["quadruped"] == "found" != outcomes["blob"]
    assert len(rows) == 12 + len(examples)


def rows_of(dataset: ray.data.Dataset) -> dict[str, dict]:
    return by_name(pa.concat_tables(ray.get(dataset.to_arrow_refs())))


def test_a_dataset_of_bytes_gives_the_same_rows(connected, meshes):
    given = ray.data.read_binary_files(str(meshes), include_paths=True)
    expected = without_times(rows_of(detect_dataset(str(meshes), FAST)))
    for dataset in (given, given.select_columns(["path"])):
        assert without_times(rows_of(detect_dataset(dataset, FAST))) == expected


def test_poison_leaves_the_rows_of_its_own_block(connected, meshes):
    write_mesh(meshes / "crash-1.ply", 2)
    paths = sorted(meshes.iterdir(), key=lambda path: (path.name < "lobed-3", path.name))
    assert 0 < [path.name for path in paths].index("crash-1.ply") < len(paths) - 1 < BATCH_MESHES
    one_block = ray.data.from_items([{"path": str(path)} for path in paths], override_num_blocks=1)
    rows = rows_of(detect_dataset(one_block, FAST))
    assert len(rows) == 13
    assert [name for name, row in rows.items() if row["outcome"] == "error"] == ["crash-1.ply"]


def test_further_symmetries_are_there_when_asked_for(connected, tmp_path):
    write_mesh(tmp_path / "a.ply", 2)
    (row,) = detect_dataset(str(tmp_path), {**FAST, "symmetries": 3, "plausibility": 0}).take_all()
    assert row["symmetries"] == 1 + len(row["further"]) > 1
    assert all(len(further["partner"]) == row["vertices"] for further in row["further"])


def test_a_wrong_option_is_said_before_anything_starts(connected, meshes):
    with pytest.raises(intrinsym.OptionError, match='no option "sampels"'):
        detect_dataset(str(meshes), {"sampels": 3})


def test_large_meshes_are_alone_and_small_ones_in_blocks_that_shrink(connected):
    place = place_of("/a")
    sizes = [BLOCK_BYTES + 1, BLOCK_BYTES, 400_000, *[10_000] * 5000]
    meshes = [MeshFile(place.at(f"/{index}"), size) for index, size in enumerate(sizes)]
    blocks = blocks_of(meshes[::-1], 1)
    counts = [len(block) for block in blocks]
    assert sorted(mesh.place.path for block in blocks for mesh in block) == sorted(
        mesh.place.path for mesh in meshes
    )
    assert counts[:3] == [1, 1, BLOCK_MESHES] and counts[-1] == 1
    assert counts[2:] == sorted(counts[2:], reverse=True)


def test_two_nodes_share_the_work(connected, meshes):
    nodes = detect_dataset(str(meshes), FAST).map_batches(node_of, batch_format="pyarrow").unique("node")
    assert len(nodes) == 2


def node_of(batch):
    return batch.select(["path"]).append_column(
        "node", [[ray.get_runtime_context().get_node_id()] * len(batch)]
    )


def test_columns_are_those_of_the_schema(connected, meshes):
    assert detect_dataset(str(meshes), FAST).schema().base_schema.equals(SCHEMA)
