"""Sweeps are asked of the skin they were recorded for, however its materials may differ."""

import pytest
from rcskin.simulator.scene.scene_files import builtin_names, builtin_text, load_scene, scene_text
from rcskin.simulator.sweeps import InputError
from rcskin.simulator.sweeps.same_skin import check_same_skin, difference

GLOVE = load_scene("glove")
OUTLINE = [[0.0, 0.0], [0.09, 0.0], [0.09, 0.06], [0.0, 0.05]]


def changed(**keys):
    return scene_text(GLOVE.with_({key.replace("__", "."): keys[key] for key in keys}))


@pytest.mark.parametrize("name", builtin_names())
def test_a_scene_file_and_what_is_kept_of_it_are_one_skin(name):
    assert difference(builtin_text(name), scene_text(load_scene(name))) is None


@pytest.mark.parametrize(
    "keys",
    [
        {"name": "other"},
        {"skin__sheet_resistance": 1e5},
        {"skin__foam": {"capacitance_per_area": 1e-9, "loss_tangent": 0.1}},
        {"contact__top-left__resistance": 30.0},
        {"leads": {"resistance": 2.0, "stray_capacitance": 1e-12}},
        {"press__factor_spread": 0.3},
        {"sweep__frequencies": [1e3, 2e3]},
        {"readout__magnitude_noise": 0.1},
    ],
)
def test_what_sessions_and_calibration_change_may_differ(keys):
    check_same_skin(scene_text(GLOVE), changed(**keys), "run.nc")


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        ({"pixels": 4}, "pixels 3x4, not 4x4"),
        ({"skin__length": 0.1}, "length 0.09 m, not 0.1 m"),
        ({"skin__width": 0.07}, "width 0.06 m, not 0.07 m"),
        (
            {"skin__outline": {"points": OUTLINE}, "contact__1__edge": "outline.4"}
            | {"contact__2__edge": "outline.4"},
            "another outline",
        ),
        (
            {"contact__top-left__edge": "top"},
            "foils bottom left and top left, not bottom left and top top",
        ),
        (
            {"contact__top-left__span": [0.0, 0.5]},
            "foils bottom left and top left, not bottom left and top left 0-0.5",
        ),
    ],
)
def test_what_makes_another_skin_is_named(keys, told):
    assert difference(scene_text(GLOVE), changed(**keys)) == told


def test_foils_otherwise_driven_make_another_skin():
    scene = load_scene("sheet-5x5-two-interfaces")
    second = scene.interfaces[1]
    other = scene.with_({f"interface.1.{side}": getattr(second, side) for side in ("high", "low")})
    told = difference(scene_text(scene), scene_text(other))
    assert told is not None
    assert told.startswith("interface left bottom left 0.005-1 against top left 0.005-1, not ")


def test_leads_may_be_swapped():
    swapped = changed(interface__left__high=["bottom-left"], interface__left__low=["top-left"])
    assert difference(scene_text(GLOVE), swapped) is None


def test_a_further_interface_makes_no_other_skin():
    further = [{"name": n, "high": ["top-left"], "low": ["bottom-left"]} for n in ("left", "again")]
    table = GLOVE.model_dump(mode="json", by_alias=True, exclude_none=True)
    both = type(GLOVE).model_validate({**table, "interface": further})
    assert difference(scene_text(GLOVE), scene_text(both)) is None


def test_another_skin_is_refused_in_one_line():
    told = (
        r"^run.nc: recorded for sheet-5x5, but used for sheet-3x3: pixels 5x5, not 3x3; "
        "--anyway ignores this$"
    )
    with pytest.raises(InputError, match=told):
        check_same_skin(builtin_text("sheet-5x5"), builtin_text("sheet-3x3"), "run.nc")
    with pytest.raises(
        InputError, match="^columns.npz: trained for sheet-5x5, but used for glove: "
    ):
        check_same_skin(builtin_text("sheet-5x5"), builtin_text("glove"), "columns.npz", "trained")


@pytest.mark.parametrize("text", ["", "no scene; another", 'name = "bare"', "skin = 3"])
def test_sweeps_that_keep_no_scene_are_not_refused(text):
    check_same_skin(text, scene_text(GLOVE), "run.nc")
    check_same_skin(scene_text(GLOVE), text, "run.nc")
