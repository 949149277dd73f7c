"""Objects of the engine are closed when their user says so, not when the garbage collector comes by."""

from __future__ import annotations

import threading

#: Held while a handle is taken for a call or given back, so that no call sees one that another thread gives back.
_HANDLES = threading.Lock()


def make_closable(cls: type) -> None:
    """Gives a generated class ``close`` and ``with``, and makes use after that a ``ValueError``."""
    take_handle = cls._uniffi_clone_handle
    free = cls.__del__

    def close(self) -> None:
        """Frees what the object holds, once calls on other threads have returned; a second time does nothing."""
        with _HANDLES:
            if getattr(self, "_handle", None) is not None:
                free(self)
                self._handle = None

    def checked_handle(self):
        with _HANDLES:
            if getattr(self, "_handle", None) is None:
                raise ValueError(f"this {cls.__name__} has been closed")
            return take_handle(self)

    cls.close = close
    cls._uniffi_clone_handle = checked_handle
    cls.__enter__ = lambda self: self
    cls.__exit__ = lambda self, *_raised: self.close()
