"""Many meshes, on one machine or a cluster, with Ray: ``pip install "intrinsym[ray]"``.

    import intrinsym.ray
    rows = intrinsym.ray.detect_dataset("scans/", {"effort": "fast"})
    rows.select_columns(["path", "outcome", "plausibility"]).write_parquet("out")

The command ``intrinsym-batch`` does the same into a folder, and goes on where an earlier run was stopped.
"""

try:
    import ray as _ray  # noqa: F401
    import ray.data as _ray_data  # noqa: F401
except ImportError as error:
    raise ImportError(
        'intrinsym.ray needs Ray, which is not installed: pip install "intrinsym[ray]"'
    ) from error

from ._dataset import detect_dataset
from ._rows import SCHEMA

__all__ = ["SCHEMA", "detect_dataset"]
