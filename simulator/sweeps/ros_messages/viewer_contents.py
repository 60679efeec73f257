"""Contents of the standard messages that viewers of ROS 2 show: a position, and pixels."""

from __future__ import annotations

import array
from typing import TYPE_CHECKING, Any

import numpy as np

from .contents import header
from .definitions import FRAME

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def image_message(time: float, values: ArrayLike, frame: str = FRAME) -> dict[str, Any]:
    """Content of an Image in single precision. time: see `header`. values: shape (row, column)."""
    pixels = np.asarray(values, dtype="<f4")
    rows, columns = pixels.shape
    return {
        "header": header(time, frame),
        "height": rows,
        "width": columns,
        "encoding": "32FC1",
        "is_bigendian": 0,
        "step": 4 * columns,
        "data": array.array("B", pixels.tobytes()),
    }


def position_message(
    time: float, position: ArrayLike, deviation: ArrayLike, frame: str = FRAME
) -> dict[str, Any]:
    """Content of a PoseWithCovarianceStamped with the axes of the frame.

    time: see `header`. position, deviation: x and y, m; NaN: unknown.
    """
    x, y = np.asarray(position, dtype=float).tolist()
    covariance = np.zeros((6, 6))
    covariance[[0, 1], [0, 1]] = np.square(deviation)
    pose = {"position": {"x": x, "y": y, "z": 0.0}, "orientation": {"w": 1.0}}
    return {
        "header": header(time, frame),
        "pose": {"pose": pose, "covariance": covariance.ravel().tolist()},
    }
