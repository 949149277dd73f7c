"""Samples as numpy arrays."""

from __future__ import annotations

import os
from typing import Union

import numpy as np

from .fieldwalk_ffi import RecordingReader
from .sample_batch import RECORDS

_HEADER_BYTES = 14


def unpack(batch: bytes) -> dict[str, np.ndarray]:
    """The samples of a batch by kind, each kind a structured array with a field ``time_ns`` and the kind's own.

    ``unpack(batch)["magnetic_field"]["x_ut"]`` is the field along x. A kind of which there is none is absent; a record
    of a kind that is unknown is left out.

    :raises ValueError: when the bytes are not one whole batch.
    """
    if batch[:4] != b"FWSB" or len(batch) != int.from_bytes(batch[10:14], "little"):
        raise ValueError("not a sample batch, or not all of one")
    parts: dict[int, list[bytes]] = {}
    at = _HEADER_BYTES
    while at < len(batch):
        code, n_bytes = batch[at], batch[at + 1] if at + 1 < len(batch) else 0
        if n_bytes < 10 or at + n_bytes > len(batch):
            raise ValueError("a record of the batch is torn")
        parts.setdefault(code, []).append(batch[at + 2 : at + n_bytes])
        at += n_bytes
    arrays = {}
    for code, (name, n_bytes, fields) in RECORDS.items():
        whole = [part for part in parts.get(code, ()) if len(part) == n_bytes - 2]
        if whole:
            arrays[name] = np.frombuffer(b"".join(whole), dtype=fields)
    return arrays


def read_recording(path: Union[str, os.PathLike]) -> dict[str, np.ndarray]:
    """All of a recording by kind, as :func:`unpack`, in order of time, and its waypoints as ``waypoint``: ``time_ns``,
    ``x_m`` and ``y_m``.

    :raises ApiError: when the recording does not exist, cannot be read, or is none.
    """
    parts: dict[str, list[np.ndarray]] = {}
    waypoints = []
    with RecordingReader.open(os.fspath(path)) as reader:
        while (part := reader.next_part(100_000)) is not None:
            for name, array in unpack(part.samples).items():
                parts.setdefault(name, []).append(array)
            if part.waypoint is not None:
                waypoints.append((part.waypoint.time_ns, part.waypoint.point.x_m, part.waypoint.point.y_m))
    arrays = {name: np.concatenate(several) for name, several in parts.items()}
    arrays["waypoint"] = np.array(waypoints, dtype=[("time_ns", "<i8"), ("x_m", "<f8"), ("y_m", "<f8")])
    return arrays
