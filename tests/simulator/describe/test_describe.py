"""A scene in words and as a drawing."""

import re

import numpy as np
import pytest
from rcskin.simulator.describe.distinct_pixels import equal_sweep_groups, indistinguishable_pixels
from rcskin.simulator.describe.facts import assumed, key_facts, prefixed
from rcskin.simulator.describe.secondary_effects import secondary_effects
from rcskin.simulator.models.line import cut_off_frequency
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.pixels import pixels_with_skin
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene_files import BUILTIN, load_scene

CORNERS = [[0, 0], [0.12, 0], [0.12, 0.05], [0.05, 0.05], [0.05, 0.12], [0, 0.12]]
L_SHAPE = {
    "skin.outline": {"points": CORNERS},
    "contact.1.edge": "outline.5",
    "contact.2.edge": "outline.5",
}
HOLE = {"circle": [0.03, 0.03, 0.01]}
DISC = {
    "skin.outline": {"circle": [0.06, 0.06, 0.06]},
    "contact.1.edge": "outline",
    "contact.2.edge": "outline",
}
SKINS = {"rectangle": {}, "L": L_SHAPE, "disc": DISC}


def skin(changes, name="sheet-3x3"):
    return load_scene(name).with_(changes)


def said(scene):
    return {each.about: each.text for each in key_facts(scene.parts)}


def effect(scene, about):
    """The first effect of that name; those after it are not computed."""
    return next(text for name, text in secondary_effects(scene) if name == about)


def test_the_papers_sheet_in_words(run):
    code, out, err = run("describe", "sheet-5x5")
    assert (code, err) == (0, "")
    for told in (
        "rectangle of 120 x 120 mm",
        "50 kohm/sq",
        "70 pF in all, 2.8 pF for each whole pixel",
        "top-left: top sheet, edge left, ideal",
        "5 rows x 5 columns, 24 x 24 mm each",
        "20, from 1 kHz to 200 kHz",
        "5.46 kHz (Eq. 6, 120 mm from the foils): 13 of 20 frequencies lie above it",
        "rows 1 and 5; 2 and 4 give the same sweeps, all columns differ: 15 of 25",
        "0.3 % of |Z| and 0.149 degrees in each reading",
        "skin.foam.phase_exponent = 1.0",
    ):
        assert told in out


@pytest.mark.parametrize(
    ("about", "changes", "told"),
    [
        ("skin", {"skin.stretch": {"x": 1.2}}, "stretched to 1.2 times its length and 0.913"),
        ("skin", {"skin.shape": {"kind": "sphere", "radius": 0.1}}, "on a sphere of radius 100 mm"),
        ("skin", L_SHAPE | {"skin.outline.holes": [HOLE]}, "cm², 1 hole"),
        (
            "frequencies",
            {"sweep.frequencies": [1e3, 3e5]},
            "meter IM3523 reads 40 Hz to 200 kHz; 300 kHz is outside (within reach of IM3536, ",
        ),
        (
            "frequencies",
            {"sweep.frequencies": [3.0, 1e3]},
            "3 Hz is outside (within reach of IM3533)",
        ),
        ("top sheet", {"skin.top.piezoresistance": 2.0}, "rises by 2 times the strain of the foam"),
        ("top sheet", {"skin.top.map": {"kind": "gradient", "x": 0.2}}, "varies by a gradient map"),
        (
            "top sheet",
            {"skin.top.anisotropy": {"ratio": 3.0, "angle": 0.5}},
            "conducts 3 times as well along 28.6 degrees",
        ),
        ("foam", {"skin.foam.phase_exponent": 0.9}, "constant phase with exponent 0.9"),
        ("foam", {"skin.foam.loss_tangent": 0.01}, "tan d 0.01"),
        ("press", {"press": {"capacitance_factor": 3.0, "factor_spread": 0.1}}, "varies by 10 %"),
    ],
)
def test_heterogeneous_properties_are_described(about, changes, told):
    assert told in said(skin(changes))[about]


def test_a_map_of_the_foam_changes_the_capacitance_by_its_mean():
    plain = said(skin({}))["capacitance"]
    rising = skin({"skin.foam.map": {"kind": "gradient", "x": 0.4}})
    assert said(rising)["capacitance"] == plain and "a gradient map" in said(rising)["foam"]
    denser = skin({"skin.foam.map": {"kind": "grid", "values": [[2.0, 2.0]]}})
    assert said(denser)["capacitance"] != plain


def test_area_and_capacitance_are_those_within_the_outline():
    found = said(skin(L_SHAPE))
    assert "polygon of 6 corners within 120 x 120 mm, 95 cm²" in found["skin"]
    assert found["capacitance"].startswith("46.2 pF in all")
    disc = said(skin(DISC))
    assert "disc of radius 60 mm" in disc["skin"]
    assert disc["capacitance"].startswith(prefixed(np.pi * 0.06**2 * 4.861e-9, "F"))


def test_a_meter_without_noise_is_described(run, tmp_path):
    text = (BUILTIN / "sheet-3x3.toml").read_text(encoding="utf-8")
    (tmp_path / "mine.toml").write_text(text.partition("[readout]")[0], encoding="utf-8")
    _, out, _ = run("describe", tmp_path / "mine.toml")
    assert "none: readings are exact" in out and "the defaults of [readout]" in out


def test_a_meter_by_its_data_sheet_is_described():
    scene = load_scene("sheet-3x3").with_({"readout": {"data_sheet": {"accuracy": "E4980A"}}})
    assert said(scene)["noise"] == (
        "1 times the fixed error in each reading, the accuracy of E4980A over root 3, fixed for a "
        "session"
    )
    assert not any(key.startswith("readout.magnitude") for key in assumed(scene))


def test_keys_of_the_file_are_not_listed_as_assumed():
    told = assumed(load_scene("glove"))
    assert "skin.foam.loss_tangent = 0.0" in told and "the defaults of [leads]" in told
    assert not any("sheet_resistance" in key or "readout" in key for key in told)


def test_pixels_without_skin_are_left_out():
    assert (3, 3) not in pixels_with_skin(skin(L_SHAPE).parts.skin)
    assert len(pixels_with_skin(skin(L_SHAPE).parts.skin)) == 8
    assert len(pixels_with_skin(skin(DISC).parts.skin)) == 9


@pytest.mark.parametrize(
    ("changes", "groups"),
    [
        ({}, 6),
        ({"skin.bottom.sheet_resistance": 1e3}, 6),
        ({"contact.top-left.span": [0.0, 0.5]}, 9),
        (L_SHAPE, 8),
        (DISC, 3),
        ({**DISC, "skin.foam.map": {"kind": "gradient", "x": 0.2}}, 6),
        ({**DISC, "skin.top.anisotropy": {"ratio": 2.0, "angle": 0.3}}, 5),
        ({"skin.foam.map": {"kind": "gradient", "y": 0.2}}, 9),
        ({"contact.bottom-left.edge": "bottom"}, 6),
        ({"contact.bottom-left.edge": "bottom", "skin.bottom.sheet_resistance": 1e3}, 9),
        ({"contact.bottom-left.edge": "right"}, 4),
    ],
)
def test_pixels_have_equal_sweeps_only_on_symmetric_skins(changes, groups):
    scene = skin(changes)
    assert (
        len(
            equal_sweep_groups(
                scene.parts.skin, scene.parts.setup, scene.press, pixels_with_skin(scene.parts.skin)
            )
        )
        == groups
    )


@pytest.mark.parametrize("changes", [DISC, {"contact.bottom-left.edge": "right"}])
def test_pixels_with_equal_sweeps_have_the_same_impedance(changes):
    scene = skin({**changes, "sweep.frequencies": (2e4,)})
    solver = Solver(scene.parts, 1e-3)

    def shown(row, column):
        return solver.solve(Press((Touch(row, column, 2.0),))).Z

    groups = equal_sweep_groups(
        scene.parts.skin, scene.parts.setup, scene.press, pixels_with_skin(scene.parts.skin)
    )
    largest = max(groups, key=len)
    other = next(group[0] for group in groups if group is not largest)
    first = shown(*largest[0])
    for pixel in largest[1:]:
        np.testing.assert_allclose(shown(*pixel), first, rtol=3e-3)
    assert np.abs(shown(*other) / first - 1).max() > 5e-3


def test_a_skin_without_symmetry_is_described():
    scene = skin(L_SHAPE)
    told = indistinguishable_pixels(
        scene.parts.skin,
        scene.parts.setup,
        scene.press,
        pixels_with_skin(skin(L_SHAPE).parts.skin),
    )
    assert told.startswith("none: every pixel gives a sweep of its own")


@pytest.mark.parametrize(
    ("kind", "ending"), [*((kind, "svg") for kind in SKINS), ("L", "png"), ("disc", "pdf")]
)
def test_a_drawing_names_foils_and_pixels(run, tmp_path, kind, ending):
    scene, path = skin(SKINS[kind]), tmp_path / f"out.{ending}"
    from rcskin.simulator.scene.scene_files import scene_text

    (tmp_path / "mine.toml").write_text(scene_text(scene), encoding="utf-8")
    code, out, _ = run("describe", tmp_path / "mine.toml", "-o", path)
    assert code == 0 and out.endswith(f"drawing -> {path}\n")
    assert path.stat().st_size > 5_000
    if ending == "svg":
        drawn = path.read_text(encoding="utf-8")
        assert "<!-- top-left, top (high) -->" in drawn
        assert "<!-- bottom-left, bottom (low) -->" in drawn
        named = {f"{i},{j}" for i in (1, 2, 3) for j in (1, 2, 3) if f"<!-- {i},{j} -->" in drawn}
        assert named == {f"{i},{j}" for i, j in pixels_with_skin(scene.parts.skin)}
        assert "<!-- column 1 -->" in drawn and "<!-- row 1 -->" in drawn


def test_another_ending_is_refused_before_any_work(refused):
    assert "must end in .png or .svg or .pdf" in refused(
        "describe", "no-such-scene", "-o", "out.bmp"
    )


def test_each_interface_has_the_cut_off_of_its_own_foils():
    """The place farthest from the foils of one pair is nearer to those of another."""
    long = load_scene("sheet-5x5-two-interfaces").with_({"skin.length": 0.18, "skin.width": 0.07})
    left, bottom = (each.text for each in key_facts(long.parts) if each.about == "cut-off")
    assert left.startswith("left: ") and "180 mm from the foils" in left
    assert bottom.startswith("bottom: ") and "70 mm from the foils" in bottom
    both = [cut_off_frequency(long.parts.skin, long.parts.setup, each) for each in long.interfaces]
    assert both[1] / both[0] == pytest.approx((0.18 / 0.07) ** 2, rel=1e-3)


def test_foam_in_time_and_its_size_within_a_sweep():
    """1 s of sweep of foam that creeps with 0.5 s: from 25 ms after the press to 975 ms."""
    solids = [{"share": 0.2, "time_constant": 0.5}, {"share": 0.1, "time_constant": 1e4}]
    weather = {"capacitance": 2e-3, "sheet_resistance": -1e-3}
    scene = skin(
        {
            "skin.foam.relaxation": solids,
            "skin.foam.hysteresis": 0.05,
            "skin.foam.temperature": weather,
            "experiment.timing.speed": "SLOW",
            "experiment.temperature": 31.0,
        }
    )
    told = list(secondary_effects(scene))
    assert (
        "creep",
        "by 20 % of the strain, time constant 500 ms: 16 % in a sweep of 1 s",
    ) in told
    assert any(text.startswith("by 10 % of the strain") for _, text in told)
    assert ("hysteresis", "5 % of the work of a press is lost on release") in told
    assert dict(told)["temperature"].startswith("31 °C; with each K the foam's capacitance")
    left_out = dict(secondary_effects(skin({})))["creep"]
    assert left_out.endswith("would creep by 0.9 % in a sweep of 100 ms; not in the scene")


COVER = {"thickness": 1e-3, "relative_permittivity": 3.0}
BELOW = {"distance": 5e-3}


@pytest.mark.parametrize(
    ("about", "changes", "told"),
    [
        ("earth", {}, "against a meter that floats; not in the scene: add"),
        ("earth", {"surroundings": {"low": "floating"}}, "none: the low terminal"),
        ("earth", {"surroundings": {}}, "charges nothing against earth: give rim or solved"),
        ("earth", {"surroundings": "solved"}, "against a meter that floats; in the scene"),
        ("body", {}, "5 mm from the bottom sheet, 1.77 nF/m², at earth: raises Rs by"),
        ("body", {"surroundings.body": BELOW}, "5 mm from the bottom sheet, 1.77 nF/m², at earth"),
        ("body", {"surroundings.body": {**BELOW, "potential": "low"}}, "a guard that follows low"),
        ("body", {"surroundings.body": {**BELOW, "potential": "floating"}}, "1.77 nF/m², floating"),
        ("body", {"surroundings.body.capacitance_per_area": 1e-9}, "facing the bottom sheet, 1 nF"),
        ("rim", {}, "assumed to be included in"),
        (
            "rim",
            {"surroundings.rim": True},
            "have 5.7 % of the foam's capacitance, which raises Rs by",
        ),
        ("rim", {"surroundings": "solved"}, "computed by the three-dimensional solve"),
        ("rim", {"surroundings.rim": 5e-12}, "given as 5 pF/m between the sheets, 0 F/m and 0"),
        ("thickness", {}, "3.6 mm (relative permittivity 2 assumed): a field that is not"),
        ("thickness", {"skin.foam.thickness": 4e-3}, "4 mm: a field that is not perpendicular"),
        ("thickness", {"surroundings.thickness": True}, "; in the scene"),
        ("walls", {}, "the field at the walls around a pressed pixel changes Rs by"),
        ("finger", {}, "against a rod; not in the scene"),
        (
            "finger",
            {"surroundings.cover": COVER},
            "a rod presses, unless a press ends in `:finger`",
        ),
        (
            "finger",
            {"surroundings": {}, "press.finger": 4e-12},
            "one of 4 pF on a pixel raises Rs by",
        ),
        (
            "finger",
            {"surroundings.body": {**BELOW, "side": "top"}},
            "none: a finger cannot touch the top sheet, which has surroundings.body in front",
        ),
        ("foil width", {}, "an overlap of foils and sheets by 1 mm lowers Rs by"),
        (
            "foil width",
            {"contact.1.width": 5e-3},
            "by 5 mm, which lowers Rs by",
        ),
    ],
)
def test_neglected_effects_are_described(about, changes, told):
    """Named in the scene or not."""
    assert told in effect(skin(changes), about)


FAR = {"surroundings.body": {"distance": 4.0}}
NEAR = {"surroundings.body": {"distance": 4e-3}}
BARE = {"surroundings": {}}
RIM = {"surroundings.rim": True}


@pytest.mark.parametrize("name", ["sheet-3x3", "strip-1x3"])
@pytest.mark.parametrize(
    ("about", "given", "without", "included"),
    [
        ("earth", {}, {**RIM, "surroundings.low": "floating"}, RIM),
        ("earth", NEAR, {**NEAR, "surroundings.low": "floating"}, NEAR),
        ("body", {}, BARE, {"surroundings.body": {"distance": 5e-3}}),
        ("body", NEAR, BARE, NEAR),
        ("body", FAR, BARE, FAR),
        ("body", {**NEAR, **RIM}, RIM, {**NEAR, **RIM}),
        ("rim", {}, BARE, RIM),
        ("thickness", {"skin.foam.thickness": 9e-3}, BARE, {"surroundings.thickness": True}),
    ],
)
def test_sizes_of_effects_are_those_of_sweeps(name, about, given, without, included):
    """The stated range is that over the scene's interfaces and frequencies, within a fifth."""
    scene = load_scene(name)
    text = effect(scene.with_(given), about)
    kept = {key: value for key, value in given.items() if key.startswith("skin")}
    before, after = (
        Solver(scene.with_({**kept, **changes}).parts, 1e-6).solve(Press())
        for changes in (without, included)
    )
    omega = 2 * np.pi * before.frequency
    Cp = [(1 / each.Z).imag / omega for each in (before, after)]
    for quantity, change in (("Rs", after.Z.real / before.Z.real), ("Cp", Cp[1] / Cp[0])):
        _check_range(text, quantity, 100 * (change - 1))


def _check_range(text, quantity, percent):
    """The words about a quantity state the range of its changes in percent."""
    verb, bound, first, last = re.search(
        rf"(raises|lowers|changes) {quantity} by (up to |less than )?"
        r"([-\d.e]+)(?: to \+?([\d.e-]+))?",
        text,
    ).groups()
    low, high = float(percent.min()), float(percent.max())
    if verb == "lowers":
        low, high = -high, -low
    least, most = (None, float(first)) if bound else (float(first), float(last or first))
    near = {"rel": 0.2, "abs": 1e-3}
    if bound == "less than ":
        assert max(-low, high) <= most
        return
    assert high == pytest.approx(most, **near)
    assert (abs(low) <= 0.012) if least is None else (low == pytest.approx(least, **near))
