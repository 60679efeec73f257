"""A virtual skin and a live session, each on its page, as their commands serve them."""

import os
import subprocess
import sys
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import pytest
from rcskin.localization.model.localizer_file import save
from rcskin.localization.model.training import train
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import concatenate

SCENE = "strip-1x3"


@dataclass(frozen=True)
class Pages:
    """Addresses of both pages, and the virtual meter's control port."""

    skin: str
    live: str
    control: str


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    """A model of the strip's columns against rest."""
    scene, random = load_scene(SCENE), np.random.default_rng(0)
    presses = ["none"] * 3 + [f"1,{j}:{f}" for j in (1, 2, 3) for f in (1.8, 2.0, 2.2)]
    exact = simulate(Solver(scene.parts), [parse_press(press, 2.0) for press in presses])
    sweeps = concatenate([read_out(exact, scene.readout, random, k) for k in range(4)])
    path = tmp_path_factory.mktemp("model") / "strip.npz"
    save(path, train(sweeps, "column", quantities=("dlnZ", "dphase")))
    return path


@contextmanager
def command(*words):
    """A command of rcskin as a process of its own, told to end in the end."""
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    words = [sys.executable, "-m", "rcskin", *map(str, words)]
    with subprocess.Popen(words, env={**os.environ, "PYTHONUNBUFFERED": "1"}, **pipes) as process:
        try:
            yield process
        finally:
            process.terminate()
            process.communicate()


@pytest.fixture(scope="module")
def pages(chromium, model):
    """Both of them, the live one on the virtual meter of the other."""
    anywhere = ("--port", 0, "--control-port", 0, "--pace", 0.2)
    with command("meter", "serve", "--scene", SCENE, "--page", *anywhere) as meter:
        resource, _, control = meter.stdout.readline().split()
        skin = meter.stdout.readline().split()[1]
        live = ("live", "--model", model, "--resource", resource, "--plain", "--page")
        with command(*live, "--timeout", 1) as session:
            told = next(line for line in session.stdout if "page http" in line)
            yield Pages(skin, told.split()[-1], control)


@pytest.fixture
def open_page(chromium):
    """A function that opens an address; nothing may be told on its console."""
    opened = []

    def open_page(url, **options):
        page = chromium.new_context(viewport={"width": 1300, "height": 1000}, **options).new_page()
        told = []
        page.on("console", lambda message: told.append(message.text))
        page.on("pageerror", lambda error: told.append(str(error)))
        opened.append((page, told))
        page.goto(url)
        return page

    yield open_page
    for page, told in opened:
        page.context.close()
        assert told == []
