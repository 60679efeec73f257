"""What sweeps are of: from a data set's own numbers or from the text of the press."""

import numpy as np
import pytest
from rcskin.localization.inputs.targets import has_target, labels, positions
from rcskin.simulator.measure.sweep_touches import touches_of
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import InputError

SCENE = scene_text(
    load_scene("sheet-5x5").with_(
        {
            "skin.width": 0.06,
            "pixels.rows": 2,
            "pixels.columns": 4,
            "press.capacitance_factor": 1.7,
        }
    )
)
PRESSES = ["none", "2,1", "1,4:2.5", "rect(0.01,0.02,5e-3,1e-2):3.0", "disc(0.03,0.04,0.01):2e+0"]


@pytest.fixture
def pressed(strip):
    def press(texts, scene=SCENE):
        sweeps = strip.isel(sweep=slice(len(texts))).assign_attrs(scene=scene)
        return sweeps.assign_coords(press=("sweep", np.array(texts, dtype=object)))

    return press


def test_places_and_strengths_are_read_from_texts(pressed):
    told = positions(pressed(PRESSES[1:]))
    np.testing.assert_allclose(
        told, [[15, 45, 1.7], [105, 15, 2.5], [10, 20, 3.0], [30, 40, 2.0]], rtol=1e-12
    )


def test_a_data_sets_own_numbers_are_taken_where_it_has_them(pressed):
    sweeps = pressed(["1,1:2.0", "none"]).assign(
        touches=("sweep", [1, 0]),
        touch_x=(("sweep", "touch"), [[0.1, 0.0], [0.0, 0.0]]),
        touch_y=(("sweep", "touch"), [[0.2, 0.0], [0.0, 0.0]]),
        touch_factor=(("sweep", "touch"), [[3.0, 1.0], [1.0, 1.0]]),
    )
    np.testing.assert_allclose(positions(sweeps.isel(sweep=[0])), [[100, 200, 3.0]])


def test_touches_are_counted_and_named(pressed):
    sweeps = pressed(["none", "2,3:1.5", "2,3:1.5+1,4:2.0"])
    assert labels(sweeps, "touches").tolist() == [0, 1, 2]
    assert labels(sweeps, "pair").tolist() == ["0,0", "2,3", "1,4+2,3"]
    assert touches_of(sweeps).factor.tolist() == [[1, 1], [1.5, 1], [1.5, 2]]


def test_a_target_is_had_only_where_the_press_has_it(pressed):
    sweeps = pressed(["none", "1,1", "1,1+1,2", PRESSES[3]])
    assert has_target(sweeps, "position").tolist() == [False, True, False, True]
    assert has_target(sweeps, "pair").tolist() == [True, True, True, False]
    assert has_target(sweeps, "touches").all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("thumb", "'thumb': must be ROW,COLUMN"),
        ("1,1+1,2+1,3", "must be at most 2 touches"),
        ("1,1:much", "FACTOR must be finite and > 0, got much"),
        ("rect(1e9999,0,1,1):2", "X must be a finite number, got 1e9999"),
    ],
)
def test_a_press_of_another_kind_is_refused(pressed, text, message):
    with pytest.raises(InputError, match=message):
        touches_of(pressed([text]))


def test_a_pixel_has_no_place_without_a_scene(pressed):
    with pytest.raises(InputError, match="the sweeps store no scene"):
        positions(pressed(["1,1:2.0"], scene=""))


def test_an_unknown_target_is_refused_with_those_there_are(strip):
    with pytest.raises(InputError, match="pair, position, got 'depth'"):
        has_target(strip, "depth")
