"""`rcskin live --page` and `rcskin meter serve --page`: pace, slow viewers, hostile clients.

The commands themselves, as a user starts them, at the virtual meter's own pace. In Chromium, a
pixel is pressed on the skin's page, and the answer awaited on the live page.

Run: python benchmarks/live/live_page.py [--quick]
"""

from __future__ import annotations

import asyncio
import json
import os
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from shutil import which
from threading import Event, Thread

import numpy as np
from rcskin.benchmarks.bench import Run, launch, rcskin_command, run_rcskin
from rcskin.benchmarks.live.hostile_clients import Target, besieged, fuzzed
from rcskin.hardware.control_client import send_request
from rcskin.simulator.scene.scene_files import load_scene
from websockets.sync.client import connect


@dataclass(frozen=True)
class Linked:
    """A virtual meter and a live session at it, with their pages."""

    meter: subprocess.Popen
    live: subprocess.Popen
    control: str
    skin: str
    answers: str


@contextmanager
def linked(scene: str, model: Path) -> Iterator[Linked]:
    """Both of them, at the virtual meter's own pace."""
    anywhere = ["--port", 0, "--control-port", 0]
    with ExitStack() as stack:
        meter = stack.enter_context(
            _command("meter", "serve", "--scene", scene, "--page", *anywhere)
        )
        assert meter.stdout is not None
        resource, _, control = meter.stdout.readline().split()
        skin = meter.stdout.readline().split()[1]
        words = ["live", "--model", model, "--resource", resource, "--plain", "--page"]
        live = stack.enter_context(_command(*words))
        assert live.stdout is not None
        told = next(line for line in live.stdout if "page http" in line)
        next(line for line in live.stdout if line.count("\t") == 3)
        Thread(target=live.stdout.read, daemon=True).start()
        yield Linked(meter, live, control, skin, told.split()[-1])


def ended_in(process: subprocess.Popen) -> float:
    """Seconds from Ctrl-C to the end."""
    begun = time.monotonic()
    process.send_signal(signal.SIGINT)
    process.wait()
    return time.monotonic() - begun


def memory(process: subprocess.Popen) -> float:
    """Of a process, MB."""
    lines = Path(f"/proc/{process.pid}/status").read_text().splitlines()
    return int(next(line for line in lines if line.startswith("VmRSS")).split()[1]) / 1e3


@contextmanager
def _command(*words: object) -> Iterator[subprocess.Popen]:
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    with subprocess.Popen(rcskin_command(*words), env=environment, **pipes) as process:
        try:
            yield process
        finally:
            if process.poll() is None:
                ended_in(process)


NEVER = float("inf")


@dataclass
class Viewer:
    """Draws each frame in so many s. frames: numbers, by when they came (s)."""

    url: str
    slowness: float
    frames: dict[int, float] = field(default_factory=dict)
    longest: float = 0.0
    """s from one frame to the next."""

    def watch(self, stop: Event) -> None:
        """Until it is told to stop."""
        target = Target(self.url)
        with connect(target.link, origin=target.origin, compression=None) as socket:
            latest = time.monotonic()
            while not stop.is_set():
                try:
                    frame = json.loads(socket.recv(timeout=0.2))["frame"]
                except TimeoutError:
                    continue
                now = time.monotonic()
                self.longest, latest = max(self.longest, now - latest), now
                self.frames[frame] = now
                stop.wait(min(self.slowness, 3600))
                socket.send(json.dumps({"do": "seen", "frame": frame}))

    def age(self, other: Viewer) -> float:
        """By how much frames came later than to another viewer, s, at most."""
        both = self.frames.keys() & other.frames.keys()
        return max((self.frames[n] - other.frames[n] for n in both), default=0.0)


class Watching:
    """Viewers in threads of their own while the block runs, from their first frame on."""

    def __init__(self, url: str, *slowness: float) -> None:
        self.viewers = [Viewer(url, each) for each in slowness]
        self._stop = Event()
        self._threads = [
            Thread(target=viewer.watch, args=(self._stop,), daemon=True) for viewer in self.viewers
        ]

    def __enter__(self) -> list[Viewer]:
        for thread in self._threads:
            thread.start()
        end = time.monotonic() + PATIENCE
        while not all(viewer.frames for viewer in self.viewers):
            if time.monotonic() > end:
                raise RuntimeError(f"a viewer was sent no frame in {PATIENCE:g} s")
            time.sleep(0.01)
        return self.viewers

    def __exit__(self, *error: object) -> None:
        self._stop.set()
        for thread in self._threads:
            thread.join()


SEED = 5
SLOW = 1.0
MARGIN = 34
"""Pixels of the screen around the skin on its canvas."""
PATIENCE = 30.0
TAUGHT, FEWEST = 2000, 60
"""Sweeps of the localizer: of 300, one press in eight was taken for its neighbour at first."""
FASTEST = 5e-3
"""s that a sweep takes at least."""
WATCH = """
() => {
  window.told = [];
  const answer = document.getElementById("live-answer");
  new MutationObserver(() => window.told.push([Date.now(), answer.textContent]))
    .observe(answer, { childList: true });
}
"""


def trained(scene: str, sweeps: int, folder: Path) -> Path:
    """A model of columns against rest, of randomised skins."""
    data, model = folder / "skins.zarr", folder / "columns.npz"
    run_rcskin("dataset", scene, "--sweeps", sweeps, "-o", data)
    run_rcskin("train", data, "--target", "column", "--features", "dlnZ,dphase", "-o", model)
    return model


def press_to_answer(pages: Linked, scene: str, presses: int, picture: Path) -> list[float] | None:
    """s from a press on the one page to its answer on the other; None without a browser.

    picture: of the last answer.
    """
    chromium = which("chromium") or which("chromium-browser")
    if find_spec("playwright") is None or chromium is None:
        print("playwright or chromium is not installed: nothing is pressed in a browser")
        return None
    from playwright.sync_api import sync_playwright

    columns, random = load_scene(scene).pixels.columns, np.random.default_rng(SEED)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        skin, live = (browser.new_context().new_page() for _ in range(2))
        skin.goto(pages.skin)
        live.goto(pages.answers)
        live.locator("#live-answer", has_text="Nothing").wait_for()
        live.evaluate(WATCH)
        times, before = [], 0
        for _ in range(presses):
            column = before = 1 + (before + int(random.integers(columns - 1))) % columns
            begun = time.time()
            click(skin, (column - 0.5) / columns)
            times.append(answered(live, f"Column {column},", begun) - begun)
            live.wait_for_timeout(1000 * random.random())
        live.set_viewport_size({"width": 1180, "height": 900})
        live.wait_for_timeout(2000)
        live.locator(".linked").screenshot(path=picture)
        browser.close()
    return times


def click(skin, across: float) -> None:
    """Press in a row in the middle. across: part of the skin's length."""
    box = skin.locator("#skin").bounding_box()
    x = box["x"] + MARGIN + across * (box["width"] - 2 * MARGIN)
    skin.mouse.click(x, box["y"] + box["height"] / 2)


def answered(live, wanted: str, since: float) -> float:
    """When an answer was shown, s since 1970-01-01. Raises RuntimeError where it never is."""
    end = time.time() + PATIENCE
    while time.time() < end:
        for at, text in live.evaluate("window.told"):
            if at >= 1e3 * since and text.startswith(wanted):
                return at / 1e3
        live.wait_for_timeout(20)
    raise RuntimeError(f"no answer {wanted!r} in {PATIENCE:g} s")


def left_out(pages: Linked, seconds: float) -> list[dict[str, str]]:
    """What viewers of one page are sent that draw at once, in SLOW s, and never."""
    before = memory(pages.live)
    with Watching(pages.answers, 0.0, SLOW, NEVER) as viewers:
        time.sleep(seconds)
        grown = memory(pages.live) - before
    quick, slow, stuck = viewers
    if not len(stuck.frames) == 1 < len(slow.frames) < len(quick.frames):
        raise AssertionError("frames wait for slow viewers")
    told = f"{len(slow.frames)} of {len(quick.frames)} frames"
    return [
        row(f"sent to a viewer that draws for {SLOW:g} s, in {seconds:g} s", told),
        row("by how much they were late there, at most", f"{1e3 * slow.age(quick):.0f} ms"),
        row("sent to a viewer that never draws", f"{len(stuck.frames)} frame"),
        row("memory of the session grew by", f"{grown:.1f} MB"),
    ]


def besiege(pages: Linked, clients: int, messages: int) -> list[dict[str, str]]:
    """Hostile clients and messages at the skin's page, with a viewer that looks on."""
    send_request(pages.control, "press", press="none")
    target, random = Target(pages.skin), np.random.default_rng(SEED)
    before, begun = memory(pages.meter), time.monotonic()
    with Watching(pages.skin, 0.0) as (viewer,):
        asyncio.run(besieged(target, clients, random))
        asyncio.run(fuzzed(target, messages, random))
    lasted, grown = time.monotonic() - begun, memory(pages.meter) - before
    if send_request(pages.control, "state")["press"] != "none" or pages.live.poll() is not None:
        raise AssertionError("the skin was touched, or the session ended")
    return [
        row(f"{clients} hostile clients and {messages} fuzzed messages", f"{lasted:.0f} s"),
        row("longest wait of a viewer for a frame meanwhile", f"{1e3 * viewer.longest:.0f} ms"),
        row("memory of the virtual meter grew by", f"{grown:.1f} MB"),
        row("presses of the skin by them", "none"),
    ]


def row(what: str, figure: str) -> dict[str, str]:
    """Of the table."""
    return {"what": what, "measured": figure}


def main(run: Run) -> None:
    """Press, watch, besiege, end."""
    scene = run.sized("sheet-5x5", "strip-1x3")
    with run.kept() as folder:
        model = trained(scene, run.sized(TAUGHT, FEWEST), folder)
        with linked(scene, model) as pages:
            times = press_to_answer(pages, scene, run.sized(30, 2), run.results / "live_page.png")
            rows = left_out(pages, run.sized(20.0, 4.0))
            rows += besiege(pages, run.sized(1000, 60), run.sized(10_000, 100))
            ends = [ended_in(pages.live), ended_in(pages.meter)]
    if times is not None:
        if min(times) < FASTEST:
            raise AssertionError("an answer came before its sweep")
        median, most = np.median(times), np.quantile(times, 0.95)
        pressed = f"{median:.2f} s; 19 of 20 within {most:.2f} s"
        rows.insert(0, row(f"press on the page to its answer, median of {len(times)}", pressed))
    rows.append(
        row("Ctrl-C to the end, session and meter", " and ".join(f"{s:.1f} s" for s in ends))
    )
    run.publish("live_page", f"{scene} on its pages, live", rows)


if __name__ == "__main__":
    launch(main)
