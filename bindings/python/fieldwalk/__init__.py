"""Indoor positioning from the magnetic field, steps and beacons: on the device, offline.

Begin with :func:`replay`, which runs a recording on a map and gives numpy arrays. :class:`BuildingMap` opens maps,
:class:`Positioner` follows a wearer live, :class:`Surveyor` makes maps, :class:`Recorder` and :class:`RecordingReader`
write and read recordings, :class:`SampleBatch` packs samples, and :func:`unpack` gives those of a batch as arrays.

What is refused raises a case of :class:`ApiError`, which has an ``explanation`` and a ``remedy``.
"""

from . import fieldwalk_ffi as _engine
from .closing import make_closable as _make_closable
from .fieldwalk_ffi import *  # noqa: F401, F403
from .arrays import read_recording, unpack
from .replay import Replayed, replay
from .sample_batch import SampleBatch

for _name in _engine.__all__:
    _made = getattr(_engine, _name)
    if isinstance(_made, type) and hasattr(_made, "_uniffi_clone_handle"):
        _make_closable(_made)

__version__ = _engine.version()
__all__ = [
    *(name for name in _engine.__all__ if name != "InternalError" and not name.endswith("Protocol")),
    "Replayed",
    "SampleBatch",
    "read_recording",
    "replay",
    "unpack",
]
