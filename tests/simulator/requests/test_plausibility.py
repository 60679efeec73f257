"""Numbers that no skin has are told with what was likely meant; those of real skins never are."""

import pytest
from rcskin.simulator.models.line import cut_off_frequency
from rcskin.simulator.requests.plausibility import suspicious_values
from rcskin.simulator.scene.scene_files import BUILTIN, builtin_names, load_scene, scene_text

GLOVE = load_scene("glove")
MECHANICS = {"porosity": 0.9, "solid_permittivity": 3.0, "modulus": 5e4}
FOAM, STIFF = {"thickness": 3e-3, "mechanics": MECHANICS}, {**MECHANICS, "modulus": 50.0}
MILLIMETRES = {"skin.length": 90.0, "skin.width": 60.0, "skin.foam.thickness": 3.0}


@pytest.mark.parametrize("name", builtin_names())
def test_built_in_scenes_are_free_of_slips(name):
    assert suspicious_values(load_scene(name)) == []


@pytest.mark.parametrize("side", [5e-3, 0.03, 0.3, 3.0])
@pytest.mark.parametrize("sheet", [1e4, 2e5])
@pytest.mark.parametrize("thickness", [5e-4, 1e-2])
def test_skins_from_a_finger_tip_to_a_wall_are_free_of_slips(side, sheet, thickness):
    sizes = {"skin.length": side, "skin.width": 0.7 * side, "skin.foam.thickness": thickness}
    assert suspicious_values(GLOVE.with_({**sizes, "skin.sheet_resistance": sheet})) == []


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"skin.length": 90.0}, ["skin.length = 90 m; did you mean 0.09?"]),
        ({"skin.length": 9.0}, ["skin.length = 9 m; did you mean 0.09?"]),
        (
            MILLIMETRES,
            [
                "skin.length = 90 m; did you mean 0.09?",
                "skin.width = 60 m; did you mean 0.06?",
                "skin.foam.thickness = 3 m; did you mean 0.003?",
            ],
        ),
        ({"skin.width": 6e-5}, ["skin.width = 6e-05 m; did you mean 0.06?"]),
        ({"leads.stray_capacitance": 8.0}, ["leads.stray_capacitance = 8 F; did you mean 8e-12?"]),
        ({"sweep.frequencies": (1e3, 2e11)}, ["sweep.frequencies = 2e+11 Hz; did you mean 2e+08?"]),
        (
            {"readout": {"phase_noise": 0.15}},
            ["readout.phase_noise = 0.15 rad; did you mean 0.00261"],
        ),
        ({"readout": {"phase_accuracy": 0.5}}, ["did you mean 0.00872665?"]),
        ({"readout": {"magnitude_noise": 0.3}}, ["noise = 0.3 of |Z|; did you mean 0.003?"]),
        ({"readout": {"magnitude_accuracy": 0.5}}, ["did you mean 0.005?"]),
        ({"skin.top.sheet_resistance": 30.0}, ["skin.top.sheet_resistance = 30 ohm/sq, but"]),
        ({"skin.bottom.sheet_resistance": 45.0}, ["= 20000 ohm/sq; did you mean 45000?"]),
        ({"skin.foam.loss_tangent": 2.0}, ["skin.foam.loss_tangent = 2; did you mean 0.02?"]),
        ({"press.capacitance_factor": 180.0}, ["did you mean 1.8?"]),
        ({"press": {"force": 1962.0}, "skin.foam": FOAM}, ["did you mean 1.962?"]),
        ({"press": {"depth": 0.5}, "skin.foam": FOAM}, ["did you mean 0.0005?"]),
        ({"skin.foam": {**FOAM, "mechanics": STIFF}}, ["modulus = 50 Pa; did you mean 50000?"]),
        ({"skin.top.anisotropy": {"ratio": 2, "angle": 45.0}}, ["did you mean 0.785398?"]),
        ({"skin.shape": {"kind": "cylinder", "radius": 40.0}}, ["did you mean 0.04?"]),
        ({"contact.top-left.width": 1e-7}, ["contact[1].width = 1e-07 m"]),
        ({"surroundings.body.distance": 50.0}, ["body.distance = 50 m; did you mean 0.05?"]),
        (
            {"surroundings": {"cover": {"thickness": 1.0, "relative_permittivity": 3.0}}},
            ["surroundings.cover.thickness = 1 m; did you mean 0.001?"],
        ),
        ({"surroundings.air": 5.0}, ["surroundings.air = 5 m; did you mean 0.005?"]),
        ({"leads.inductance": 0.8}, ["leads.inductance = 0.8 H; did you mean 8e-07?"]),
        (
            {"contact.1.resistance": 2e6},
            ["contact[1].resistance = 2e+06 ohm m; did you mean 2?"],
        ),
        ({"design": {"within": 8.0, "target": "position"}}, ["within = 8 m; did you mean 0.008?"]),
        ({"sweep.frequencies": (1.0, 200.0)}, ["did you mean 1000 to 200000 Hz?"]),
        ({"skin.sheet_resistance": 50.0}, ["sheet_resistance = 50 ohm/sq puts the cut-off"]),
        ({"sweep.frequencies": (5e8, 1e9)}, ["lies far below the sweep of 5e+08 to 1e+09 Hz"]),
    ],
)
def test_slips_are_reported_each_in_one_line(changes, told):
    found = suspicious_values(GLOVE.with_(changes))
    assert len(found) == len(told)
    for line, part in zip(found, told, strict=True):
        assert part in line and "\n" not in line


@pytest.mark.parametrize(
    ("given", "meant"), [(4.861, 4.861e-9), (70e-12, 70e-12 / 0.0144), (4.861e-15, 4.861e-9)]
)
def test_capacitance_in_nanofarad_of_all_or_for_each_square_millimetre(given, meant):
    sheet = load_scene("sheet-5x5").with_({"skin.foam.capacitance_per_area": given})
    assert f"did you mean {meant:.6g}?" in suspicious_values(sheet)[0]


def test_commands_warn_in_one_line_and_go_on(run, tmp_path):
    path, out = tmp_path / "big.toml", tmp_path / "out.nc"
    text = (BUILTIN / "strip-1x3.toml").read_text(encoding="utf-8")
    path.write_text(text.replace("length = 0.100", "length = 100", 1), encoding="utf-8")
    code, _, err = run("sweep", path, "--press", "none", "--rtol", "1e-2", "-o", out)
    first, *_ = err.splitlines()
    assert first.startswith(f"rcskin: warning: {path}: skin.length = 100 m; did you mean 0.1?")
    assert err.count("plausible = false, above the first table") == 1
    assert code == 0 and out.exists()


def test_a_scene_whose_unusual_numbers_are_intended_gives_no_warning():
    line = {"skin.sheet_resistance": 150.0, "skin.foam.capacitance_per_area": 0.3}
    strip = load_scene("strip-1x3")
    assert "capacitance_per_area = 0.3 F/m²" in suspicious_values(strip.with_(line))[0]
    assert suspicious_values(strip.with_({**line, "plausible": False})) == []
    assert "plausible" not in scene_text(strip)


def reach(scene):
    """Largest distance from the foils of any interface, m."""
    return scene.parts.skin.reach(scene.interfaces, scene.interfaces)


def test_the_cut_off_is_that_of_the_paper_at_the_far_end():
    strip = load_scene("strip-1x5")
    assert reach(strip) == pytest.approx(strip.skin.length)
    assert cut_off_frequency(strip.parts.skin, strip.parts.setup) == pytest.approx(
        strip.frequencies[0], rel=1e-3
    )


def test_the_farthest_place_is_where_no_driven_foil_is_near():
    crossed, two = (load_scene(f"sheet-5x5{kind}") for kind in ("", "-two-interfaces"))
    assert reach(crossed) == pytest.approx(0.12)
    everywhere = {"skin.outline": {"circle": [0.06, 0.06, 0.06]}, "contact.1.edge": "outline"}
    disc = crossed.with_({**everywhere, "contact.2.edge": "outline"})
    assert reach(disc) == pytest.approx(0.06, rel=1e-3)
    assert reach(two) < reach(crossed) * 2**0.5
