"""A page of a skin whose interfaces have frequencies of their own, beside the solver's sweep."""

import re

import numpy as np
import pytest
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.page.document import document
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene_files import read_scene
from rcskin.simulator.sweeps import read

FREQUENCIES = (1e3, 3e3, 1e4, 3e4, 1e5)
OF_EACH = {"one": (1e3, 3e3, 1e4), "two": (3e3, 3e4, 1e5)}
TAKEN = np.array([[f in own for f in FREQUENCIES] for own in OF_EACH.values()])
LEAST_NOISE = 0.1
PREFIXES = {"": 1, "k": 1e3, "M": 1e6, "m": 1e-3, "n": 1e-9, "p": 1e-12, "f": 1e-15, "µ": 1e-6}
READ = "async () => (await import('rcskin/app')).page.station.localizer.rest.length"
PRESS = "2,2:1.8"
NEAR = 4e-3
"""Of what is shown: the page's tolerance, its least noise, and three digits."""


@pytest.fixture(scope="module")
def exact(own_frequencies):
    """Rs and Cp of the skin at rest and pressed, at every frequency of every interface."""
    whole = own_frequencies.scene.with_(
        {"interface.1.frequencies": FREQUENCIES, "interface.2.frequencies": FREQUENCIES}
    )
    return simulate(
        Solver(whole.parts, 1e-5), [parse_press(press, 1.8) for press in ("none", PRESS)]
    )


@pytest.fixture
def opened(chromium, own_frequencies, tmp_path):
    """A function that opens the page at what its address holds, with as little noise as it can."""
    file = tmp_path / "own.html"
    file.write_text(document(own_frequencies.data), encoding="utf-8")
    context, told = chromium.new_context(viewport={"width": 1300, "height": 1000}), []

    def at(**state):
        page = context.new_page()
        page.on("console", lambda message: told.append(message.text))
        page.on("pageerror", lambda error: told.append(str(error)))
        held = "&".join(f"{name}={value}" for name, value in state.items())
        page.goto(f"{file.as_uri()}#noise={LEAST_NOISE}&{held}")
        page.locator("#answer:not(:empty)").wait_for()
        page.wait_for_timeout(600)
        return page

    yield at
    assert told == []
    context.close()


def press(page):
    """The middle of row 2, column 2, by keys."""
    page.locator("#skin").focus()
    for key in ("ArrowRight", "ArrowRight", "ArrowUp", "Enter"):
        page.keyboard.press(key)
    page.wait_for_timeout(600)
    return page


def taken_away(page, folder):
    paths = []
    for button in ("toml", "csv"):
        with page.expect_download() as download:
            page.locator(f"#{button}").click()
        paths.append(folder / f"away.{button}")
        paths[-1].write_bytes(download.value.path().read_bytes())
    return read_scene(paths[0]), read(paths[1])


def impedances(sweeps):
    """Z in ohm, shape (sweep, interface, frequency)."""
    return sweeps["Rs"].values + 1j * sweeps["X"].values


def numbers(page):
    """Rs in ohm and Cp in F, as they are shown."""
    text = page.text_content("#reading")
    found = re.findall(r"(?:Rs|Cp) (-?[\d.]+) (\D?)(?:ohm|F)", text)
    return [float(number) * PREFIXES[prefix] for number, prefix in found]


def test_every_interface_is_shown_at_every_frequency(opened, exact):
    page = press(opened())
    for drive in range(len(OF_EACH)):
        page.locator("#drive").select_option(str(drive))
        for at in range(len(FREQUENCIES)):
            page.locator("#at").fill(str(at))
            page.wait_for_timeout(100)
            (Rs, Cp), truth = numbers(page), impedances(exact)[1, drive, at]
            omega = 2 * np.pi * FREQUENCIES[at]
            assert abs(Rs - truth.real) < NEAR * abs(truth), (drive, at)
            assert abs(omega * Cp - (1 / truth).imag) < NEAR / abs(truth), (drive, at)


def test_what_is_taken_away_is_what_is_read(opened, exact, tmp_path):
    scene, sweeps = taken_away(press(opened()), tmp_path)
    assert list(sweeps["press"].values) == ["none", PRESS]
    np.testing.assert_array_equal(sweeps["taken"].values, TAKEN)
    np.testing.assert_array_equal(scene.parts.setup.taken, TAKEN)
    found, truth = impedances(sweeps), impedances(exact)
    assert np.isnan(found[:, ~TAKEN]).all()
    assert np.abs(found / truth - 1)[:, TAKEN].max() < NEAR
    again = impedances(simulate(Solver(scene.parts, 1e-5), [parse_press(PRESS, 1.8)]))[0]
    assert np.isnan(again[~TAKEN]).all()
    np.testing.assert_allclose(again[TAKEN], truth[1][TAKEN], rtol=1e-4)


def test_the_localizer_reads_each_interface_at_its_own(opened):
    page = press(opened())
    assert page.text_content("#answer").startswith("Row 2, column 2")
    assert page.evaluate(READ) == 2 * TAKEN.sum()
    page.locator('input[data-of="drives"]').nth(0).uncheck()
    page.wait_for_timeout(600)
    assert page.evaluate(READ) == 2 * TAKEN[1].sum()


def test_frequencies_that_an_interface_is_not_read_at_leave_it_out(opened, tmp_path):
    page = press(opened())
    boxes = page.locator('input[data-of="frequencies"]')
    for at in np.flatnonzero(TAKEN[0]).tolist():
        boxes.nth(at).uncheck()
    page.wait_for_timeout(600)
    scene, _ = taken_away(page, tmp_path)
    assert [each.name for each in scene.interfaces] == ["two"]
    assert scene.frequencies.tolist() == [3e4, 1e5] and scene.parts.setup.taken is None
    boxes.nth(3).uncheck()
    boxes.nth(4).click()
    page.wait_for_timeout(600)
    assert boxes.nth(4).is_checked() and page.evaluate(READ) == 2


def test_an_address_by_which_nothing_is_read_reads_everything(opened):
    page = press(opened(drives="[1]", frequencies="[0]"))
    assert page.text_content("#answer").startswith("Row 2, column 2")
    assert page.evaluate(READ) == 2 * TAKEN.sum()
    assert page.locator('input[data-of="drives"]').nth(0).is_checked()
    assert "drives" not in page.url and "frequencies" not in page.url
