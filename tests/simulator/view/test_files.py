"""Movies, files for ParaView, and the page for a browser, read back."""

import numpy as np
import pytest
import pyvista
from meshio.xdmf import TimeSeriesReader
from PIL import Image, ImageSequence
from rcskin.simulator.scene.scene_files import parse_scene
from rcskin.simulator.sweeps import InputError
from rcskin.simulator.view import outputs
from rcskin.simulator.view.outputs import write_movie, write_output


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
    frames = over_one_period(quantity, set_up.fields, set_up.surface(quantity), 1, 4)
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
    assert scene == set_up.parts.scene
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
