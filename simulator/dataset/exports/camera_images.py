"""Images of cameras that the user puts beside the sweeps, one for each sweep.

A camera is a folder with its name: CAMERA/episode-000000/*.png, as many images as the episode has
sweeps, in the order of their names.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...sweeps import InputError, inputs
from .episodes import Episode, EpisodePart

ENDINGS = (".png", ".jpg", ".jpeg")
IMAGES_AT_ONCE = 64
"""Largest number of images of a camera in memory."""


@dataclass(frozen=True)
class CameraImages:
    """Images of all sweeps. shape: rows and columns of pixels. files: by number of the sweep."""

    name: str
    shape: tuple[int, int]
    files: tuple[Path, ...]

    def images(self, part: EpisodePart) -> list[Path]:
        """Image files of a part's sweeps."""
        return list(self.files[part.numbers])

    def pixels(self, path: Path) -> NDArray[np.uint8]:
        """Red, green and blue of an image, shape (row, column, 3).

        Raises InputError for a file that is no image, or has another size than the first one.
        """
        with inputs.picture(path) as image:
            if (image.height, image.width) != self.shape:
                raise InputError(
                    f"{path}: has {image.width} x {image.height} pixels, but the first image of "
                    f"{self.name} has {self.shape[1]} x {self.shape[0]}"
                )
            try:
                return np.asarray(image.convert("RGB"))
            except (OSError, SyntaxError, ValueError) as error:
                raise InputError(f"{path}: cannot be read as an image: {error}") from error


def encoded(path: Path, pixels: NDArray[np.uint8]) -> dict[str, Any]:
    """An image as `datasets` stores it: the bytes of its file, as PNG if it is not in RGB."""
    from PIL import Image

    with inputs.picture(path) as image:
        if image.mode == "RGB":
            return {"bytes": path.read_bytes(), "path": None}
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, "PNG")
    return {"bytes": buffer.getvalue(), "path": None}


def cameras(folders: Sequence[Path], episodes: Sequence[Episode]) -> list[CameraImages]:
    """The cameras of these folders.

    Raises InputError if a folder or the folder of an episode is missing, if an episode has another
    number of images than sweeps, or if two cameras have one name.
    """
    names = [folder.resolve().name for folder in folders]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"--images: two folders are called {name!r}; name each by its camera")
    return [_camera(folder, name, episodes) for folder, name in zip(folders, names, strict=True)]


def _camera(folder: Path, name: str, episodes: Sequence[Episode]) -> CameraImages:
    if "/" in name or not name.isprintable():
        raise InputError(f"{folder}: the name of a camera must be printable")
    files = [file for episode in episodes for file in _images(folder, episode)]
    with inputs.picture(files[0]) as first:
        shape = first.height, first.width
    inputs.check_memory(folder, min(len(files), IMAGES_AT_ONCE) * 3 * shape[0] * shape[1])
    return CameraImages(name, shape, tuple(files))


def _images(folder: Path, episode: Episode) -> list[Path]:
    own = folder / f"episode-{episode.number:06d}"
    if not own.is_dir():
        raise InputError(
            f"{own}: no such folder; --images needs one for each episode, here the "
            f"{episode.sweeps} sweeps of session {episode.session}"
        )
    found = sorted(file for file in own.iterdir() if file.suffix.lower() in ENDINGS)
    if len(found) != episode.sweeps:
        raise InputError(
            f"{own}: has {len(found)} images ({', '.join(ENDINGS)}), but its episode has "
            f"{episode.sweeps} sweeps; one image for each sweep is needed"
        )
    return found
