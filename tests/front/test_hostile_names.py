"""Names and texts that come from others are shown in every output, and obeyed in none."""

import csv
import io
import os
import pickle
import re
import sys
import unicodedata
from contextlib import redirect_stderr, redirect_stdout
from html.parser import HTMLParser

import numpy as np
import pytest
import rcskin
from matplotlib.figure import Figure
from matplotlib.text import Text
from rcskin.__main__ import main
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.sweeps import InputError, build

SCRIPT = "<script>alert(1)</script>"
NAME = rf'it [red][/][link=x] <!--{SCRIPT}"><img src=x onerror=alert(1)> $x_$ \frac{{ 100 %'
OBEYED = "\x1b[31m\x1b]0;title\x07\x9b2J\u202e\u2028\r\n=1+1"
"""Colours, a title, a cleared screen, text set from right to left, and other lines."""
CONTROLS = {"Cc", "Cf", "Zl", "Zp"}
READOUT = {"magnitude_noise": 2e-3, "phase_noise": 2e-3}
SOURCE = re.compile("<!--<script>|<script>alert|" + re.escape(r"\u003cscript\u003ealert"))


def hostile():
    """A strip whose texts are all hostile, as far as a scene takes them."""
    contacts = (("=1+1", "top", "left"), ("+x", "bottom", "left"), ("@x", "bottom", "right"))
    named = {name: f"{name} {NAME}" for name, _, _ in contacts}
    return rcskin.load("strip-1x3").with_(
        {
            "name": f"-x {NAME}",
            "description": OBEYED + NAME,
            "pixels": {"rows": 1, "columns": 2},
            "contact": [
                {"name": named[name], "electrode": sheet, "edge": edge}
                for name, sheet, edge in contacts
            ],
            "interface": [
                {"name": f"=2+{k} {NAME}", "high": [named["=1+1"]], "low": [named[low]]}
                for k, low in enumerate(("+x", "@x"))
            ],
            "sweep.frequencies": [1e3, 1e4, 1e5],
            "readout": READOUT,
            "press.factor_spread": 0.1,
            "experiment": {"repetitions": 2, "unpressed": True},
        }
    )


class Reading(HTMLParser):
    """What of a page a browser would run or load: handlers, and tags that come from names."""

    def __init__(self):
        super().__init__()
        self.faults = []

    def handle_starttag(self, tag, attrs):
        self.faults += [f"<{tag} {name}" for name, _ in attrs if name.startswith("on")]
        self.faults += [f"<{tag} src=x" for pair in attrs if pair == ("src", "x")]


def controls(text):
    """Lines with characters that a terminal or an editor obeys."""
    lines = text.replace("\r\n", "\n").replace("\t", " ").split("\n")
    return [repr(line) for line in lines if {*map(unicodedata.category, line)} & CONTROLS]


def formulas(text):
    """Cells that a spreadsheet would compute, whatever it parts cells at."""
    rows = [row for by in ",;\t" for row in csv.reader(io.StringIO(text), delimiter=by)]
    cells = [cell for row in rows for cell in row if cell[:1] in "=+-@\t\r＝＋－＠" and cell]
    return [cell for cell in cells if not re.fullmatch(r"[+-]?[\d.]+(e[+-]?\d+)?", cell)]


def faults(name, content):
    """What is wrong with a file of that name, or with what a terminal shows."""
    text = content.decode("utf-8", errors="surrogateescape")
    if name.endswith((".html", ".svg")):
        page = Reading()
        page.feed(text)
        return page.faults + [found[0] for found in SOURCE.finditer(text)]
    if name.endswith(".md"):
        return re.findall(r"(?<!\\)[<$*\[&].*", text.partition("Interfaces: ")[2]) + controls(text)
    if name.endswith(".csv"):
        return formulas(text) + controls(text)
    return controls(text)


@pytest.fixture
def command(monkeypatch, tmp_path):
    """Runs a command in a folder of its own; what it showed goes to the other files there."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "500")

    def command(*arguments):
        shown = io.StringIO()
        monkeypatch.setattr(sys, "argv", ["rcskin", *map(str, arguments)])
        with redirect_stdout(shown), redirect_stderr(shown), pytest.raises(SystemExit) as ended:
            main()
        number = len(list(tmp_path.glob("terminal-*")))
        path = tmp_path / f"terminal-{number}-{arguments[0]}"
        path.write_bytes(shown.getvalue().encode())
        assert ended.value.code == 0, shown.getvalue()

    return command


@pytest.fixture
def charts(monkeypatch):
    """Charts are set but not painted; their files hold what stands in them."""

    def save(figure, path, **_):
        figure.draw_without_rendering()
        texts = [each.get_text() for each in figure.findobj(Text)]
        path.write_text("\n".join(texts), encoding="utf-8", newline="\n")

    monkeypatch.setattr(Figure, "savefig", save)


QUICK = """
    sweep it.toml --explain -o it.nc
    sweep it.toml -o it.csv
    describe it.toml -o it.png
    plot it.nc it.csv --what Rs -o plot.png
    plot it.nc it.csv --what Rs -o plot.html
    check it.nc --noise 1e-3 -o checked
    join it.nc it.csv --session %s -o joined.nc
    export joined.nc -o joined.csv
    export it.nc -o it.parquet
    export it.nc --format lerobot -o card
    train it.nc it.nc it.nc it.nc it.nc it.nc --features Rs,Cp --estimator ksvm-ovo -o column.npz
    localize column.npz joined.csv
    localize column.npz joined.csv -o column.csv
    evaluate column.npz joined.csv -o evaluated
"""
SLOW = """
    sweep it.toml -o it.nc
    sweep it.toml -o it.csv
    view it.toml -o view.png
    view it.toml -o view.vtu
    page it.toml -o page.html
    dataset it.toml --sweeps 200 --workers 1 --rtol 1e-2 -o set.zarr
    export set.zarr -o set.csv
    train set.zarr --target position -o position.npz
    evaluate position.npz it.nc -o evaluated
    study it.toml --vary skin.foam.loss_tangent=0.01,0.02 --workers 1 -o study.csv
    limits it.toml -o limits
    frequencies it.toml -n 2
    calibrate it.toml it.nc --fit capacitance -o fit
    gap it.nc it.csv --calibration-touches 1 --draws 1 -o gap
"""
BINARY = (".nc", ".npz", ".parquet", ".zarr", ".vtu")


@pytest.mark.parametrize(
    "lines", [QUICK, pytest.param(SLOW, marks=pytest.mark.slow)], ids=["quick", "slow"]
)
def test_every_output_shows_hostile_names_and_obeys_none(tmp_path, command, charts, lines):
    (tmp_path / "it.toml").write_text(scene_text(hostile()), encoding="utf-8")
    for line in lines.strip().splitlines():
        command(*(OBEYED + NAME if word == "%s" else word for word in line.split()))
    found = [
        f"{path.name}: {fault[:200]}"
        for path in tmp_path.rglob("*")
        if path.is_file() and not {*BINARY} & {each.suffix for each in (path, *path.parents)}
        for fault in faults(path.name, path.read_bytes())
    ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize("name", ["interface", "press"])
def test_sweeps_have_no_names_that_are_obeyed(name):
    labels = {"interface": ["left"], "press": ["none"], "row": [0], "column": [0]}
    with pytest.raises(InputError, match=f"`{name}` must be printable, on one line") as refused:
        build([[[1 - 1j]]], [1e3], **{**labels, name: [OBEYED]}).dataset()
    assert str(refused.value).isprintable()


class Mkdir:
    """What a pickle of it does when it is read."""

    def __reduce__(self):
        return os.mkdir, ("owned",)


def packed(content):
    """An archive whose array is a pickle, as NumPy and others store objects."""
    file = io.BytesIO()
    np.savez(file, Rs=np.array([content], dtype=object))
    return file.getvalue()


PROGRAMS = {
    "pickle": pickle.dumps(Mkdir()),
    "text pickle": b"cposix\nmkdir\n(S'owned'\ntR.",
    "archive of pickles": packed(Mkdir()),
    "Python": b"__import__('os').mkdir('owned')\n",
    "YAML": b"!!python/object/apply:os.mkdir [owned]\n",
    "template": b"{{ cycler.__init__.__globals__.os.mkdir('owned') }},{0.__class__}\n1,2\n",
    "shell": b"#!/bin/sh\nmkdir owned; $(mkdir owned)\n`mkdir owned`\n",
    "page": b"<?php mkdir('owned'); ?><script>fs.mkdir('owned')</script>\n",
}
TAKEN = """
    check it.nc
    check it.csv
    plot it.csv -o it.png
    describe it.toml
    import it.csv -o made.nc
    import it.s1p -o made.nc
    import it.txt -o made.nc
    import it.xlsx -o made.nc
    import it.z -o made.nc
    import it.json -o made.nc
    import it.dta -o made.nc
    localize it.npz it.csv
    export it.npz -o it.c
    sweep it.toml -o made.nc
    sweep glove --press it.toml -o made.nc
    meter record glove --resource x --reader it.toml -o made.nc
    meter record glove --resource x --accuracy it.toml -o made.nc
    meter record glove --resource x --order it.txt -o made.nc
    meter record glove --resource x --switch it.toml -o made.nc
    meter serve --scene glove --script it.txt
    meter serve --recorded it.nc
"""


@pytest.mark.parametrize("program", PROGRAMS)
def test_no_content_of_a_file_is_run(run, tmp_path, monkeypatch, program):
    """Whatever stands in it, and whichever command takes it."""
    monkeypatch.chdir(tmp_path)
    for line in TAKEN.strip().splitlines():
        words = line.split()
        name = next(word for word in words if word.startswith("it."))
        (tmp_path / name).write_bytes(PROGRAMS[program])
        code, _, err = run(*words)
        assert (code, err.count("\n")) == (2, 1), err
        (tmp_path / name).unlink()
        assert not [*tmp_path.iterdir()]
