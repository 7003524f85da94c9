"""The tiny cells of the laboratory, for the faces of the event world."""

from __future__ import annotations

from tests.lab.conftest import pair, thesis

__all__ = ["pair", "thesis"]
