"""Arrays as text, for a page to read."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Real


def exact_array(values: Real) -> dict[str, Any]:
    """Array as text, exact to 1.5e-11.

    It is little-endian, row after row: the upper six of eight bytes, rounded.
    """
    whole = np.ascontiguousarray(values, "<f8").view("<u8") + np.uint64(1 << 15)
    return _text(whole.view("u1").reshape(-1, 8)[:, 2:], "float48")


def single_precision_array(values: Real) -> dict[str, Any]:
    """Array as text in single precision, little-endian, row after row."""
    return _text(np.ascontiguousarray(values, "<f4").view("u1"), "float32")


def _text(numbers: NDArray[np.uint8], kind: str) -> dict[str, Any]:
    return {"type": kind, "base64": base64.b64encode(numbers.tobytes()).decode()}
