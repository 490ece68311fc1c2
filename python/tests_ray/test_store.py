"""What is done about files of results that cannot be read."""

from __future__ import annotations

from pathlib import Path

import pytest

from intrinsym.ray._inputs import place_of
from intrinsym.ray._rows import table_of
from intrinsym.ray._store import Store


def test_a_file_stays_if_only_its_storage_fails(tmp_path: Path, monkeypatch):
    store = Store.open(place_of(str(tmp_path)), {})
    store.commit(store.stage(table_of([{"path": "a.off", "outcome": "none"}])))
    (part,) = Path(store.rows).glob("*.parquet")

    def failing(self, name, columns=None):
        raise OSError("the storage is away")

    with monkeypatch.context() as patch:
        patch.setattr(Store, "_read", failing)
        with pytest.raises(OSError, match="away"):
            store.known()
    assert part.exists() and set(store.known()) == {"a.off"}
    part.write_bytes(part.read_bytes()[:100])
    assert store.known() == {} and not part.exists()
