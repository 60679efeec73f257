"""Movies, files for ParaView, and the page for a browser, read back."""

import base64
import json
import re

import numpy as np
import pytest
import pyvista
from meshio.xdmf import TimeSeriesReader
from PIL import Image, ImageSequence
from rcskin.simulator.scene.scene_files import parse_scene
from rcskin.simulator.sweeps import InputError
from rcskin.simulator.view import outputs
from rcskin.simulator.view.movie import write_movie
from rcskin.simulator.view.outputs import write_output


@pytest.fixture
def small_movies(monkeypatch):
    monkeypatch.setattr(outputs, "MOVIE_DPI", 40)
    monkeypatch.setattr(outputs, "PHASES", 4)


def frames_of_gif(path):
    with Image.open(path) as movie:
        return [np.asarray(frame.convert("RGB")) for frame in ImageSequence.Iterator(movie)]


@pytest.mark.pictures
@pytest.mark.parametrize(
    ("animate", "what"),
    [(None, "potential"), pytest.param("phase", "current", marks=pytest.mark.slow)],
)
def test_a_gif_has_a_frame_for_each_moment(fields, stage, tmp_path, small_movies, animate, what):
    path = tmp_path / "movie.gif"
    write_output(path, stage(fields([1e4, 1e5, 1e6])), what, animate)
    frames = frames_of_gif(path)
    assert len(frames) == (3 if animate is None else 4)
    for one, other in zip(frames, frames[1:], strict=False):
        assert (np.abs(one.astype(int) - other).max(axis=2) > 20).mean() > 0.01


def test_a_gif_keeps_the_colours_of_maps_and_foils(tmp_path):
    from matplotlib import colormaps

    bar = np.round(255 * colormaps["viridis"](np.linspace(0, 1, 64))[:, :3])
    foil = np.array([[213, 94, 0], [0, 114, 178], [255, 255, 255], [0, 0, 0]])
    image = np.vstack([bar, foil]).astype(np.uint8).repeat(4, axis=0)[:, None].repeat(8, axis=1)
    write_movie(tmp_path / "movie.gif", [image, image[::-1]], ["viridis"])
    for kept, given in zip(
        frames_of_gif(tmp_path / "movie.gif"), (image, image[::-1]), strict=True
    ):
        assert np.abs(kept.astype(int) - given).max() <= 6


@pytest.mark.pictures
@pytest.mark.parametrize(("long", "told"), [(0.0, 1), (1e6, 0)])
def test_a_movie_that_takes_long_is_announced_after_its_first_picture(
    fields, stage, tmp_path, small_movies, monkeypatch, long, told
):
    notes, drawn = [], []
    monkeypatch.setattr(outputs, "LONG_DRAWING", long)

    def progress(work, done=None, total=1.0, /):
        drawn.append(len(notes))

    write_output(tmp_path / "movie.gif", stage(fields()), "power", None, progress, notes.append)
    assert len(notes) == told and drawn == [0, told, told, told]
    assert all("movie.gif: 3 pictures, about 1 min" in note for note in notes)


@pytest.mark.pictures
def test_an_mp4_has_a_frame_for_each_frequency(fields, stage, tmp_path, small_movies):
    from imageio_ffmpeg import count_frames_and_secs

    path = tmp_path / "movie.mp4"
    write_output(path, stage(fields()), "power", "frequency")
    assert count_frames_and_secs(str(path))[0] == 3


def test_half_a_period_later_the_potential_is_reversed(fields, stage, tmp_path, small_movies):
    from rcskin.simulator.view.displayed_quantity import over_one_period
    from rcskin.simulator.view.quantities import chosen

    set_up = stage(fields())
    (quantity,) = chosen("potential", set_up.fields)
    frames = over_one_period(quantity, set_up.fields, set_up.skin(quantity), 1, 4)
    assert frames[0].values == pytest.approx(-frames[2].values)
    assert frames[0].limits == (pytest.approx(-1), pytest.approx(1))


@pytest.mark.parametrize(
    ("what", "animate", "says"),
    [("capacitance", "frequency", "same at all"), ("power", "phase", "potential or current")],
)
def test_what_does_not_move_is_no_movie(fields, stage, tmp_path, monkeypatch, what, animate, says):
    monkeypatch.setattr("rcskin.simulator.view.painting.check_drawing", lambda: None)
    with pytest.raises(InputError, match=says):
        write_output(tmp_path / "movie.gif", stage(fields()), what, animate)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("corners", [3, 4])
def test_vtu_holds_all_fields_at_all_frequencies(fields, stage, tmp_path, corners):
    given = fields(depth=1e-3, corners=corners)
    set_up = stage(given)
    write_output(tmp_path / "skin.vtu", set_up, "potential", None)
    grid = pyvista.read(tmp_path / "skin.vtu")
    assert grid.n_cells == given.cells.shape[1]
    assert np.allclose(grid.points.T, given.position)
    assert np.array_equal(grid.field_data["frequency_Hz"], given.frequency)
    Z = grid.field_data["Z_re_ohm"] + 1j * grid.field_data["Z_im_ohm"]
    assert np.array_equal(Z, given.Z)
    data = grid.point_data
    V = data["potential_top_re_V@10000Hz"] + 1j * data["potential_top_im_V@10000Hz"]
    assert np.array_equal(V, given.potential[0, 1])
    J = data["current_bottom_re_A_per_m@100000Hz"]
    assert np.array_equal(J[:, :2].T, given.current[1, 2].real)
    assert np.array_equal(data["sensitivity_ln_Rs_per_m2@1000Hz"], given.by_rise_Rs[0])
    assert np.array_equal(data["deflection_m"], given.deflection)
    scene = parse_scene(str(grid.field_data["scene"][0]), "vtu")
    assert scene == set_up.scene
    assert str(grid.field_data["press"][0]) == "3,5:2.0"


@pytest.mark.parametrize("corners", [3, 4])
def test_xdmf_has_frequency_for_time(fields, stage, tmp_path, corners):
    given = fields(corners=corners, radius=0.04)
    write_output(tmp_path / "skin.xdmf", stage(given), "potential", None)
    assert [path.name for path in tmp_path.iterdir()] == ["skin.xdmf"]
    with TimeSeriesReader(tmp_path / "skin.xdmf") as reader:
        points, cells = reader.read_points_cells()
        assert np.allclose(points.T, given.position)
        assert cells[0].data.shape == given.cells.T.shape
        for at, frequency in enumerate(given.frequency):
            time, data, _ = reader.read_data(at)
            assert time == frequency
            assert np.allclose(data["potential_bottom_im_V"], given.potential[1, at].imag)
            assert np.allclose(data["power_W_per_m2"], given.power[at])


def read_page(path):
    """The text of a page, its traces and its layout."""
    page = path.read_text(encoding="utf-8")
    decoder = json.JSONDecoder()
    start = page.index("[", re.search(r'Plotly\.newPlot\(\s*"skin",', page).end())
    traces, end = decoder.raw_decode(page, start)
    layout, _ = decoder.raw_decode(page, page.index("{", end))
    return page, traces, layout


def numbers(coded):
    return np.frombuffer(base64.b64decode(coded["bdata"]), coded["dtype"])


def test_a_page_needs_nothing_but_itself(fields, stage, tmp_path):
    given = fields(frequencies=[1e4, 1e5])
    write_output(tmp_path / "skin.html", stage(given), "potential", None)
    page, traces, _ = read_page(tmp_path / "skin.html")
    assert not re.findall(r"<(?:script|link)[^>]+(?:src|href)=", page)
    fields_shown = [trace for trace in traces if "intensity" in trace]
    assert [trace["visible"] for trace in fields_shown] == [True, False]
    for at, trace in enumerate(fields_shown):
        V = given.potential[0, at] - given.potential[1, at]
        assert np.allclose(numbers(trace["intensity"]), np.abs(V), rtol=1e-6)


@pytest.mark.parametrize(("width", "height"), [(1500, 400), (500, 500), (300, 900)])
@pytest.mark.parametrize("radius", [None, 0.04])
def test_the_whole_skin_and_its_foils_are_in_every_window(
    fields, stage, tmp_path, width, height, radius
):
    """As plotly projects: half the height seen is 1, and all axes are scaled to `aspectratio`."""
    shape = {} if radius is None else {"shape": {"kind": "cylinder", "radius": radius}}
    write_output(tmp_path / "skin.html", stage(fields(radius=radius), **shape), "potential", None)
    page, traces, layout = read_page(tmp_path / "skin.html")
    half = re.search(r"\[halfWidth, halfHeight\] = \[([\d.]+), ([\d.]+)\]", page)
    wide, high = float(half[1]), float(half[2])
    scene = layout["scene"]
    ranges = np.array([scene[f"{axis}axis"]["range"] for axis in "xyz"])
    assert scene["aspectmode"] == "manual" and np.allclose(
        np.ptp(ranges, axis=1), np.ptp(ranges[0])
    )
    places = np.hstack(
        [np.array([numbers(each[axis]) for axis in "xyz"]) for each in traces if "i" in each]
    )
    assert places[0].min() < -1 or radius
    assert (places.T >= ranges[:, 0]).all() and (places.T <= ranges[:, 1]).all()
    eye, up = ([scene["camera"][key][axis] for axis in "xyz"] for key in ("eye", "up"))
    right = np.cross(up, eye) / np.linalg.norm(np.cross(up, eye))
    above = np.cross(eye, right) / np.linalg.norm(eye)
    off = places - ranges.mean(axis=1)[:, None]
    scale = min(1 / high, width / height / wide)
    x, y = scale * right @ off, scale * above @ off
    assert np.abs(x).max() <= width / height and np.abs(y).max() <= 1
    assert max(np.abs(x).max() * height / width, np.abs(y).max()) > 0.9


def luminance(colour):
    from matplotlib.colors import to_rgb

    parts = np.array(to_rgb(colour))
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    return linear @ [0.2126, 0.7152, 0.0722]


def test_words_on_a_page_stand_out_from_their_ground(fields, stage, tmp_path):
    from matplotlib import colormaps

    write_output(tmp_path / "skin.html", stage(fields([1e6])), "potential", None)
    _, traces, layout = read_page(tmp_path / "skin.html")
    ground, words = luminance(layout["paper_bgcolor"]), luminance(layout["font"]["color"])
    assert (ground + 0.05) / (words + 0.05) > 7
    assert not layout.get("annotations")
    (names,) = [trace for trace in traces if trace.get("mode") == "text"]
    field = next(trace for trace in traces if "intensity" in trace)
    x, y = (numbers(field[axis]) for axis in "xy")
    named = np.stack([numbers(names[axis]) for axis in "xy"])
    at = [np.argmin(np.hypot(x - a, y - b)) for a, b in named.T]
    beneath = numbers(field["intensity"])[at] / field["cmax"]
    for share, colour in zip(beneath, names["textfont"]["color"], strict=True):
        light, dark = sorted([luminance(colormaps["viridis"](share)[:3]), luminance(colour)])[::-1]
        assert (light + 0.05) / (dark + 0.05) > 4


def test_a_pages_slider_says_the_frequency_and_each_step_its_scale(fields, stage, tmp_path):
    write_output(tmp_path / "skin.html", stage(fields([1e3, 1e5])), "potential", None)
    _, traces, layout = read_page(tmp_path / "skin.html")
    (slider,) = layout["sliders"]
    assert slider["currentvalue"]["prefix"] == "Frequency: "
    assert [step["label"] for step in slider["steps"]] == ["1 kHz", "100 kHz"]
    assert slider["currentvalue"].get("visible", True)
    for step, trace in zip(
        slider["steps"], (each for each in traces if "intensity" in each), strict=True
    ):
        values = numbers(trace["intensity"])
        assert trace["cmax"] == pytest.approx(values.max())
        assert trace["cmin"] in (0, pytest.approx(values.min()))
        assert np.ptp(values) > 0.3 * (trace["cmax"] - trace["cmin"])
        (told,) = step["args"][1].values()
        assert re.search(r"colours: [\d.]+ to [\d.]+ V", told)


def test_a_page_of_everything_says_what_each_step_shows(fields, stage, tmp_path):
    write_output(tmp_path / "skin.html", stage(fields([1e4])), "all", None)
    _, traces, layout = read_page(tmp_path / "skin.html")
    labels = [step["label"] for step in layout["sliders"][0]["steps"]]
    assert labels[0] == "Potential between the sheets, 10 kHz" and labels[-1] == "Capacitance"
    foils = {trace["name"] for trace in traces if trace.get("showlegend")}
    assert foils == {"top-left (high)", "bottom-left (low)"}
