"""Keys that are missing or not known: all told at once, with what was likely meant."""

import pytest
from rcskin.simulator.scene.scene_files import BUILTIN, parse_scene
from rcskin.simulator.sweeps import InputError

SHEET = (BUILTIN / "sheet-3x3.toml").read_text(encoding="utf-8")


def told(text):
    with pytest.raises(InputError) as refused:
        parse_scene(text, "mine.toml")
    message = str(refused.value)
    assert message.startswith("mine.toml: ") and "\n" not in message
    return message.removeprefix("mine.toml: ")


def sheet(*pairs):
    text = SHEET
    for old, new in zip(pairs[::2], pairs[1::2], strict=True):
        assert old in text
        text = text.replace(old, new, 1)
    return text


def test_all_missing_keys_are_named_together():
    assert told('name = "empty"') == (
        "`skin.length`, `skin.width`, `skin.top.sheet_resistance`, "
        "`skin.bottom.sheet_resistance`, `skin.foam`, `contact`, `interface`, `pixels.rows`, "
        "`pixels.columns` and `sweep.frequencies` are missing"
    )


def test_a_missing_key_does_not_hide_another_problem():
    found = told(sheet("length = 0.120", "", "rows = 3", "rows = 0"))
    assert found == "`skin.length` is missing; `pixels.rows` must be >= 1, got 0"


@pytest.mark.parametrize(
    ("old", "new", "meant"),
    [
        ("sheet_resistance", "resistance", "`skin.top.sheet_resistance`?"),
        ('edge = "left"', 'colour = "red"\nedge = "left"', None),
        ("capacitance_factor", "factor", "`press.capacitance_factor` or `press.factor_spread`?"),
        ("[readout]", "[readout]\nnoise_phase = 1e-3", "`readout.phase_noise`?"),
        (
            "[skin]\n",
            "[skin]\nsheet_resistance = 1e3\n",
            "`skin.top.sheet_resistance` or `skin.bottom.sheet_resistance`?",
        ),
        (
            "[skin]\n",
            "[skin]\nthicknes = 1e-3\n",
            "`skin.foam.thickness` or `surroundings.thickness`?",
        ),
        ("[sweep]", "[sweep]\npoints = 3", "`sweep.frequencies.points` or `skin.outline.points`?"),
    ],
)
def test_an_unknown_key_is_refused_with_a_suggestion(old, new, meant):
    _, _, suggested = told(sheet(old, new)).split("; `")[0].partition("; did you mean ")
    assert suggested == (meant or "")


def test_a_misspelt_key_is_not_also_named_as_missing():
    found = told(sheet("length", "lenght", "sheet_resistance", "resistance", "rows = 3", ""))
    assert found == (
        "`skin.top.resistance` is not a known key, got 50000.0; did you mean "
        "`skin.top.sheet_resistance`?; `skin.lenght` is not a known key, got 0.12; did you mean "
        "`skin.length`?; `pixels.rows` is missing"
    )


def test_unknown_keys_of_kinds_and_distributions_are_named():
    foam = "[skin.foam]\nmap = {kind = 'random', deviaton = 0.1}\n"
    assert "did you mean `deviation`?; `correlation_length` is missing" in told(
        sheet("[skin.foam]\n", foam)
    )
    drawn = '[dataset.press]\nfactor = {distribution = "uniform", low = 1.5, hgih = 2}\n'
    assert "`hgih` is not a known key, got 2; did you mean `high`?" in told(f"{SHEET}\n{drawn}")
