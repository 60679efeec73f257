"""Pictures of the gallery exist, are small, and come from lines that are real."""

import shlex
from pathlib import Path
from xml.etree import ElementTree

import pytest
from PIL import Image
from rcskin.benchmarks.pictures.gallery import DRAWN_HERE, LARGEST, OWN, PICTURES, shrink

from .reading import ROOT

OF_OTHERS = 350_000
"""Bytes of a picture that a benchmark draws."""


def output(words):
    """Where a command writes."""
    return words[words.index("-o") + 1]


@pytest.mark.parametrize("picture", PICTURES, ids=lambda each: each.name)
def test_every_picture_is_small_and_can_be_read(picture):
    path = ROOT / picture.file
    assert path.stat().st_size <= (LARGEST if picture.file.startswith(OWN) else OF_OTHERS)
    if path.suffix == ".svg":
        ElementTree.parse(path)
        return
    with Image.open(path) as image:
        assert image.width >= 400 and image.height >= 150


@pytest.mark.parametrize("picture", PICTURES, ids=lambda each: each.name)
def test_lines_make_the_picture_with_what_exists(picture):
    """Options and inputs of `rcskin` are tested with those of all pages."""
    for line in picture.lines.splitlines():
        program, first, *words = shlex.split(line)
        assert program in ("rcskin", "python")
        if program == "python":
            assert (ROOT / first).is_file() and words in ([], ["-o", picture.name])
    left = picture.made or picture.name
    if program == "rcskin" and left != "study.png":  # which stands beside the table
        assert output(words) in (left, str(Path(left).parent))


def test_the_script_draws_no_picture_twice():
    names = [each.name for each in PICTURES]
    assert len(set(names)) == len(names) and len(DRAWN_HERE) > 8


def test_large_pictures_and_films_become_smaller(tmp_path):
    noise = [Image.effect_noise((900, 300), 60 + k).convert("RGB") for k in range(3)]
    noise[0].save(tmp_path / "still.png")
    noise[0].save(tmp_path / "film.gif", save_all=True, append_images=noise[1:], duration=80)
    for path in (tmp_path / "still.png", tmp_path / "film.gif"):
        before = path.stat().st_size
        shrink(path)
        assert path.stat().st_size < before
    with Image.open(tmp_path / "film.gif") as film:
        assert (film.n_frames, film.info["duration"]) == (3, 80)
