"""Movies of pictures: GIF by pillow, MP4 by ffmpeg."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..sweeps import OutputError, whole_file
from .painting import PALER, ROLE_COLOURS, Image, under_grid

FPS = 8
GREYS = 24


def write_movie(path: Path, frames: Iterable[Image], colour_maps: Collection[str]) -> None:
    """Writes frames (height, width, 3) as a GIF that loops or as an MP4.

    All frames have one size. colour_maps: names of the maps that a GIF, which has 256 colours, must
    reproduce.
    """
    with whole_file(path) as unfinished:
        if path.suffix == ".gif":
            _write_gif(unfinished, frames, _palette(colour_maps))
        else:
            _write_mp4(unfinished, frames)


def _palette(colour_maps: Collection[str]) -> NDArray[np.uint8]:
    """256 colours, (256, 3): the maps, greys, and those of foils.

    Foils have paler ones too, for smooth edges. Half of the maps' colours are as the lines between
    pixels make them.
    """
    from matplotlib import colormaps
    from matplotlib.colors import to_rgb

    foils = np.array([to_rgb(colour) for colour in ROLE_COLOURS.values()])
    paler = [1 - share * (1 - foils) for share in PALER]
    fixed = np.vstack([np.repeat(np.linspace(0, 1, GREYS)[:, None], 3, axis=1), *paler])
    each = (256 - len(fixed)) // (2 * len(colour_maps))
    maps = [colormaps[name](np.linspace(0, 1, each))[:, :3] for name in sorted(colour_maps)]
    colours = np.vstack([fixed, *maps, *(under_grid(colours) for colours in maps)])
    filled = np.vstack([colours, np.repeat(colours[-1:], 256 - len(colours), axis=0)])
    return np.round(255 * filled).astype(np.uint8)


def _write_gif(path: Path, frames: Iterable[Image], colours: NDArray[np.uint8]) -> None:
    import PIL.Image

    palette = PIL.Image.new("P", (1, 1))
    palette.putpalette(colours.tobytes())
    first, *others = (
        PIL.Image.fromarray(frame).quantize(palette=palette, dither=PIL.Image.Dither.NONE)
        for frame in frames
    )
    first.save(path, save_all=True, append_images=others, duration=1000 // FPS, loop=0)


def _write_mp4(path: Path, frames: Iterable[Image]) -> None:
    from imageio_ffmpeg import write_frames

    frames = iter(frames)
    first, count = next(frames), 1
    height, width, _ = first.shape
    writer = write_frames(
        str(path), (width, height), fps=FPS, quality=8, macro_block_size=2, output_params=["-an"]
    )
    writer.send(None)
    try:
        writer.send(first)
        for frame in frames:
            writer.send(frame)
            count += 1
    finally:
        writer.close()
    _check_movie(path, count)


def _check_movie(path: Path, count: int) -> None:
    """Raises OutputError if ffmpeg could not write all frames; it does not say so."""
    from imageio_ffmpeg import count_frames_and_secs

    with suppress(RuntimeError):
        if count_frames_and_secs(path)[0] == count:
            return
    raise OutputError("the movie could not be written whole; is the disk full?")
