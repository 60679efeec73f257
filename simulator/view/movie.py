"""Pictures one after the other: GIF by pillow, MP4 by ffmpeg where it is installed."""

from __future__ import annotations

from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from simulator.sweeps import InputError, whole_file
from simulator.view.painting import Image

FPS = 8


def check_movie(path: Path) -> None:
    """Raises InputError for an MP4 where ffmpeg is not installed."""
    if path.suffix == ".mp4" and find_spec("imageio_ffmpeg") is None:
        raise InputError(
            f"{path}: MP4 needs ffmpeg: install rcskin[movies], which brings it, or write a .gif"
        )


def write_movie(path: Path, frames: Iterable[Image]) -> None:
    """Write frames (height, width, 3), all of one size, as a GIF that loops or as an MP4."""
    check_movie(path)
    with whole_file(path) as unfinished:
        (_write_gif if path.suffix == ".gif" else _write_mp4)(unfinished, frames)


def _write_gif(path: Path, frames: Iterable[Image]) -> None:
    import PIL.Image

    drawn = list(frames)
    colours = np.unique(np.concatenate([_colours(frame) for frame in drawn]), axis=0)
    palette = PIL.Image.fromarray(colours[None]).quantize(256)
    first, *others = (
        PIL.Image.fromarray(frame).quantize(palette=palette, dither=PIL.Image.Dither.NONE)
        for frame in drawn
    )
    first.save(path, save_all=True, append_images=others, duration=1000 // FPS, loop=0)


def _colours(frame: Image) -> Image:
    """Every colour of a frame once, (colour, 3), so that a bar's count as much as a field's."""
    return np.unique(frame.reshape(-1, 3), axis=0)


def _write_mp4(path: Path, frames: Iterable[Image]) -> None:
    from imageio_ffmpeg import write_frames

    frames = iter(frames)
    first = next(frames)
    height, width, _ = first.shape
    writer = write_frames(
        str(path), (width, height), fps=FPS, quality=8, macro_block_size=2, output_params=["-an"]
    )
    writer.send(None)
    try:
        writer.send(first)
        for frame in frames:
            writer.send(frame)
    finally:
        writer.close()
