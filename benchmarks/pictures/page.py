"""The page on which a skin is pressed: its size, what it takes to make, and from press to paint, of
a hundred presses."""

from __future__ import annotations

import io
import sys
import tempfile
import time
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from shutil import which

import numpy as np
from PIL import Image
from rcskin.benchmarks.bench import Run, launch
from rcskin.simulator.models.mechanics.force_depths import pressed_by_factors
from rcskin.simulator.page.document import document
from rcskin.simulator.page.packed import page_data, reduced_for_page
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

RTOL, CELLS, PRESSES = 1e-3, 2, 100
UNEVEN = {
    f"skin.{sheet}.map": {"kind": "random", "deviation": 0.2, "correlation_length": 0.03, "seed": k}
    for k, sheet in enumerate(("top", "bottom"))
}
MOVIE = {"width": 1180, "height": 1480}
PATH = [(0.25, 0.5), (0.35, 0.5), (0.45, 0.48), (0.55, 0.45), (0.65, 0.4), (0.75, 0.35), (0.8, 0.3)]
TIMED = """
async ([presses, seed]) => {
  const canvas = document.getElementById("skin");
  const box = canvas.getBoundingClientRect();
  let state = seed;
  const random = () => (state = (state * 16807) % 2147483647) / 2147483647;
  const frame = () => new Promise(requestAnimationFrame);
  const painted = () => new Promise((done) => {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = done;
    port2.postMessage(0);
  });
  const times = [];
  for (let k = 0; k < presses; k++) {
    const at = { pointerId: 7, bubbles: true,
      clientX: box.left + (0.15 + 0.7 * random()) * box.width,
      clientY: box.top + (0.15 + 0.7 * random()) * box.height };
    await new Promise((done) => setTimeout(done, 30 + 40 * random()));
    const start = performance.now();
    canvas.dispatchEvent(new PointerEvent("pointerdown", at));
    await frame();
    const begun = performance.now();
    await painted();
    times.push([performance.now() - start, performance.now() - begun]);
    canvas.dispatchEvent(new PointerEvent("pointerup", at));
  }
  return times;
}
"""


@dataclass(frozen=True)
class Page:
    """A page on disk: its size in MB, and the seconds it took to make."""

    path: Path
    size: float
    seconds: float


def made(scene: Scene, folder: Path) -> Page:
    """The page of a scene."""
    start, plain = time.perf_counter(), pressed_by_factors(scene.parts)
    text = document(page_data(plain, reduced_for_page(plain, RTOL, CELLS)))
    path = folder / f"{scene.name}.html"
    path.write_text(text, encoding="utf-8")
    return Page(path, len(text) / 1e6, time.perf_counter() - start)


def press_to_paint(browser, page: Page, presses: int) -> np.ndarray:
    """From press to paint, and of that the page's own work, ms, shape (press, 2)."""
    opened = browser.new_page(viewport={"width": 1300, "height": 1000})
    opened.goto(page.path.as_uri())
    opened.locator("#answer:not(:empty)").wait_for()
    opened.wait_for_timeout(1500)
    times = np.array(opened.evaluate(TIMED, [presses, 12345]))
    if not opened.locator("#answer").text_content().strip():
        sys.exit(f"{page.path.name}: nothing was answered")
    opened.close()
    return times


def movie(browser, page: Page, path: Path) -> None:
    """A finger that moves over the skin, as a GIF."""
    opened = browser.new_page(viewport=MOVIE)
    opened.goto(page.path.as_uri())
    opened.wait_for_timeout(800)
    box, frames = opened.locator("#skin").bounding_box(), []
    for k, (across, down) in enumerate(PATH):
        opened.mouse.move(box["x"] + across * box["width"], box["y"] + down * box["height"])
        if k == 0:
            opened.mouse.down()
        opened.wait_for_timeout(400)
        picture = Image.open(io.BytesIO(opened.screenshot()))
        small = picture.resize((3 * picture.width // 5, 3 * picture.height // 5), Image.LANCZOS)
        frames.append(small.convert("P", palette=Image.ADAPTIVE, colors=96))
    opened.close()
    first, *others = frames
    first.save(path, save_all=True, append_images=others, duration=900, loop=0, optimize=True)


def scenes(run: Run) -> list[Scene]:
    """What pages are made of."""
    two = load_scene("sheet-5x5-two-interfaces")
    larger = {"name": "sheet-6x6-two-interfaces", "pixels.rows": 6, "pixels.columns": 6}
    uneven = load_scene("sheet-5x5").with_({"name": "uneven", **UNEVEN})
    kinds = [load_scene("sheet-5x5"), two.with_(larger), load_scene("l-shape"), uneven]
    return run.sized(kinds, [load_scene("strip-1x3")])


def main(run: Run) -> None:
    """Make, open and press the pages."""
    chromium = which("chromium") or which("chromium-browser")
    if find_spec("playwright") is None or chromium is None:
        print("playwright or chromium is not installed: nothing is measured")
        return
    from playwright.sync_api import sync_playwright

    rows = []
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        for scene in scenes(run):
            page = made(scene, Path(folder))
            whole, own = press_to_paint(browser, page, run.sized(PRESSES, 5)).T
            rows.append(
                {
                    "scene": scene.name,
                    "page (MB)": f"{page.size:.2f}",
                    "made in (s)": f"{page.seconds:.1f}",
                    "own work, median (ms)": f"{np.median(own):.1f}",
                    "own work, 19 of 20 (ms)": f"{np.quantile(own, 0.95):.1f}",
                    "press to paint, median (ms)": f"{np.median(whole):.1f}",
                    "press to paint, 19 of 20 (ms)": f"{np.quantile(whole, 0.95):.1f}",
                }
            )
            if scene.name in ("sheet-5x5", "strip-1x3"):
                movie(browser, page, run.results / "page.gif")
        version = browser.version
        browser.close()
    title = f"A skin pressed on its page, in Chromium {version}"
    run.publish("page", title, rows)


if __name__ == "__main__":
    launch(main)
