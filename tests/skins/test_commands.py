"""From a skin that is no rectangle to answers, at the command line."""

import pytest
from rcskin.simulator.measure.specimen import Specimen
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.sweeps import InputError, read


@pytest.fixture
def done(run, monkeypatch, tmp_path):
    """Runs `rcskin ARGUMENTS` in a folder of the test's own, without failure; its output."""
    monkeypatch.chdir(tmp_path)

    def done(*arguments):
        code, out, err = run(*arguments)
        assert code == 0, err
        return out

    return done


HOLED = pytest.param("l with a hole", marks=pytest.mark.slow)


@pytest.mark.parametrize("kind", [HOLED, "mesh"])
def test_a_localizer_of_drawn_skins_finds_the_columns_of_another(kinds, done, tmp_path, kind):
    (tmp_path / "skin.toml").write_text(scene_text(kinds[kind]), encoding="utf-8")
    loose = ("--rtol", "1e-2")
    done("dataset", "skin.toml", "--sweeps", 60, "--workers", 1, *loose, "-o", "set.zarr")
    done("train", "set.zarr", "--features", "dlnZ,dphase", "-o", "columns.npz")
    done("sweep", "skin.toml", "--model", "reduced", *loose, "-o", "swept.nc")
    swept = read(tmp_path / "swept.nc")
    pressed = {*zip(swept["row"].values.tolist(), swept["column"].values.tolist(), strict=True)}
    assert (2, 2) not in pressed and {(0, 0), (1, 1), (1, 2)} <= pressed
    told = done("localize", "columns.npz", "swept.nc").splitlines()
    assert len(told) >= swept.sizes["sweep"]
    assert "accuracy" in done("evaluate", "columns.npz", "swept.nc")


def test_a_pixel_without_skin_is_no_press_of_the_virtual_skin(kinds):
    skin = Specimen(kinds["l with a hole"].parts, "meter")
    assert skin.check("2,1") == "2,1:2.0"
    with pytest.raises(InputError, match="press 2,2:2.0: there is no skin at that place"):
        skin.check("2,2")
