"""Recordings of several mountings as one: sessions stay apart, what was measured stays whole.

Sweeps are asked of the skin they were recorded for, however its materials may differ.
"""

import json

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from rcskin.simulator.scene.scene_files import builtin_names, builtin_text, load_scene, scene_text
from rcskin.simulator.sweeps import InputError, build, read, read_joined, side_by_side, write
from rcskin.simulator.sweeps.formats.csv import NO_SESSIONS
from rcskin.simulator.sweeps.joining import join
from rcskin.simulator.sweeps.same_skin import check_same_skin, difference

SCENE = 'name = "s"\n# not a remark, a "text" with a \\ in it\n\tand a tab\n'
Z = np.array([1e4 - 2e4j, 9e3 - 1e4j, 8e3 - 5e3j])


def recorded(name="", begun=0.0, frequency=(1e3, 2e3, 4e3), interface=("left", "right"), **more):
    """Two sweeps, at rest and pressed."""
    shape = (2, len(interface), 3)
    attributes = {
        "scene": SCENE,
        "settings": '{"speed": "SLOW"}',
        "flagged": "[[1, 0, 2]]",
        "times": json.dumps([begun, begun + 1]),
        **({"sessions": json.dumps({0: name})} if name else {}),
        **more,
    }
    return build(
        np.broadcast_to(Z * (1 + 1e-6 * begun), shape),
        frequency,
        interface=interface,
        press=["none", "1,1"],
        row=[0, 1],
        column=[0, 1],
        time=[begun, begun + 1],
        attributes=attributes,
    ).dataset()


def test_each_recording_is_a_session_of_its_own():
    joined = join([recorded(begun=n) for n in (0, 10, 20)], "abc")
    assert list(joined["session"].values) == [0, 0, 1, 1, 2, 2]


def test_recordings_of_one_name_are_one_session_with_its_name():
    parts = [recorded("mon", 0), recorded(begun=5), recorded("tue", 10), recorded("mon", 20)]
    joined = join(parts, "abcd")
    assert list(joined["session"].values) == [0, 0, 1, 1, 2, 2, 0, 0]
    assert json.loads(joined.attrs["sessions"]) == {"0": "mon", "2": "tue"}


def test_joined_once_more_sessions_stay_what_they_were():
    first = join([recorded("mon", 0), recorded("tue", 10)], "ab")
    again = join([first, recorded("mon", 20), recorded(begun=30)], "abc")
    assert list(again["session"].values) == [0, 0, 1, 1, 0, 0, 2, 2]


def test_they_follow_each_other_in_time_whatever_the_order_of_files():
    joined = join([recorded(begun=20), recorded(begun=0)], "ab")
    assert list(joined["time"].values) == [0, 1, 20, 21]
    assert json.loads(joined.attrs["times"]) == [0, 1, 20, 21]


def test_flags_and_settings_of_both_are_joined():
    joined = join([recorded(begun=0), recorded(begun=10, settings="other")], "ab")
    assert json.loads(joined.attrs["flagged"]) == [[1, 0, 2], [3, 0, 2]]
    assert joined.attrs["scene"] == SCENE
    assert joined.attrs["settings"] == '{"speed": "SLOW"}; other'


def test_interfaces_may_stand_in_another_order():
    swapped = recorded(begun=5).isel(interface=[1, 0])
    joined = join([recorded(), swapped], "ab")
    assert list(joined["interface"].values) == ["left", "right"]


def test_what_only_some_of_them_have_is_left_out():
    untimed = recorded().drop_vars("time")
    joined = join([recorded(), untimed], "ab")
    assert "time" not in joined.variables and joined.sizes["sweep"] == 4


SKIN = """name = "n"
contact = []
interface = []
pixels = {{rows = 1, columns = {columns}}}
skin = {{length = 0.1, width = 0.1}}
"""


@pytest.mark.parametrize(
    ("other", "told"),
    [
        (recorded(frequency=(1e3, 2e3, 5e3)), "b: 3 from 1000 to 5000 Hz are not the frequencies"),
        (recorded(interface=("left", "up")), "b: interfaces left, up are not those of a"),
        (recorded(scene=SKIN.format(columns=2)), "b: is of another skin than a: pixels 1x2"),
    ],
)
def test_what_does_not_fit_is_named(other, told):
    with pytest.raises(InputError, match=told):
        join([recorded(scene=SKIN.format(columns=3)), other], "ab")


def test_interfaces_recorded_one_after_the_other_have_the_time_of_the_first():
    left, right = (recorded(begun=n, interface=(name,)) for n, name in ((3, "left"), (9, "right")))
    whole = side_by_side([left, right])
    assert list(whole["time"].values) == [3, 4] and whole["time"].dims == ("sweep",)


def test_one_file_is_read_as_it_is(tmp_path):
    write(recorded("mon"), tmp_path / "a.nc")
    assert read_joined([tmp_path / "a.nc"]).identical(read(tmp_path / "a.nc"))


def test_a_csv_keeps_sessions_times_settings_and_scene(tmp_path):
    whole = join([recorded("mon", 0.125), recorded("tue, wet", 1e9 + 0.1)], "ab")
    whole.attrs |= {"seed": 3, "rtol": 1e-5, "empty": "", "crlf": "a\r\nb"}
    for ending in ("nc", "csv"):
        write(whole, tmp_path / f"a.{ending}")
    ours, theirs = read(tmp_path / "a.csv"), read(tmp_path / "a.nc")
    assert {**ours.attrs} == {**theirs.attrs}
    xr.testing.assert_identical(ours.drop_attrs(), theirs.drop_attrs())


def test_pandas_takes_the_csv_with_its_comments(tmp_path):
    write(recorded("mon"), tmp_path / "a.csv")
    table = pd.read_csv(tmp_path / "a.csv", comment="#")
    assert list(table["press"].unique()) == ["none", "1,1"]
    assert list(table["session"]) == [0] * 12


def csv(tmp_path, text):
    (tmp_path / "some.csv").write_text(text)
    return read(tmp_path / "some.csv")


def test_a_csv_without_sessions_is_one_and_says_so(tmp_path):
    sweeps = csv(tmp_path, "frequency_Hz,Rs_ohm,X_ohm\n1e3,1,-1\n")
    assert sweeps["session"].item() == 0 and sweeps.attrs["session_rule"] == NO_SESSIONS


def test_sessions_of_a_csv_may_be_names(tmp_path):
    lines = ["sweep,session,frequency_Hz,Rs_ohm,X_ohm", "0,mon,1e3,1,-1", "1,tue,1e3,1,-1"]
    sweeps = csv(tmp_path, "\n".join(lines))
    assert list(sweeps["session"].values) == [0, 1]
    assert json.loads(sweeps.attrs["sessions"]) == {"0": "mon", "1": "tue"}


def test_lines_are_counted_with_the_comments(tmp_path):
    with pytest.raises(InputError, match="line 4: `Rs_ohm` must be a finite number, got 'x'"):
        csv(tmp_path, "# by hand\n# by me\nfrequency_Hz,Rs_ohm,X_ohm\n1e3,x,-1\n")


def test_the_command_joins_and_counts(run, tmp_path):
    for number, name in enumerate(("mon", "tue")):
        write(recorded(name, 10.0 * number), tmp_path / f"{number}.nc")
    files, out = [tmp_path / "0.nc", tmp_path / "1.nc"], tmp_path / "all.nc"
    code, told, _ = run("join", *files, "-o", out)
    assert (code, told) == (0, f"4 sweeps x 2 interfaces x 3 frequencies, 2 sessions -> {out}\n")
    run("join", *files, "--overwrite-measured", "-o", out, "--session", "one")
    assert set(read(out)["session"].values) == {0}


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
        "`anyway=True` ignores this$"
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
