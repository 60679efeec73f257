"""What is shown: the values, their units and the ends of their scales."""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.simulator.sweeps import InputError
from rcskin.simulator.view.displayed_quantity import at_frequencies
from rcskin.simulator.view.quantities import NAMES, chosen, point_areas, prefix, scales, span_text
from rcskin.simulator.view.skin_surface import surface


def only(name, fields):
    (quantity,) = chosen(name, fields)
    return quantity


def test_all_that_is_there_is_chosen(fields):
    assert [each.name for each in chosen("all", fields())] == list(NAMES[:-1])
    assert [each.name for each in chosen("all", fields(depth=1e-3))] == list(NAMES)


def test_an_undeformed_skin_has_no_deformation(fields):
    with pytest.raises(InputError, match="press by depth or force"):
        chosen("deformation", fields())


def test_sheets_of_other_currents_are_shown_one_by_one(fields):
    even = fields()
    assert only("current", even).title == "Current density in either sheet"
    uneven = replace(even, current=even.current * np.array([1.0, 0.7])[:, None, None, None])
    top, bottom = chosen("current", uneven)
    assert np.allclose(bottom.values(uneven, 1), 0.7 * top.values(uneven, 1))


def test_units_of_potential_phase_and_sensitivity(fields):
    skin = fields(frequencies=[1e5])
    assert only("potential", skin).values(skin, 0)[0] == pytest.approx(1.0)
    V = skin.potential[0, 0] - skin.potential[1, 0]
    assert only("phase", skin).values(skin, 0) == pytest.approx(np.degrees(np.angle(V)))
    percent = only("sensitivity-Cp", skin).values(skin, 0)
    assert percent == pytest.approx(skin.by_rise_Cp[0] * 1e-4 * 100)


def test_all_capacitance_doubled_doubles_Cp_at_low_frequency(fields):
    skin = fields(frequencies=[1.0])
    percent_per_cm2 = only("sensitivity-Cp", skin).values(skin, 0)
    assert percent_per_cm2 @ point_areas(skin) * 1e4 == pytest.approx(100, rel=1e-3)


def test_areas_of_points_add_up(fields):
    for corners in (3, 4):
        assert point_areas(fields(corners=corners)).sum() == pytest.approx(0.12 * 0.08)


@pytest.mark.parametrize(
    ("highest", "unit", "factor"),
    [(0.0, "A/m", 1.0), (2e-5, "µA/m", 1e6), (1.0, "A/m", 1.0), (3.4e6, "MA/m", 1e-6)],
)
def test_prefixes_make_numbers_readable(highest, unit, factor):
    assert prefix(highest, "A/m") == (pytest.approx(factor), unit)


def test_alike_frames_share_a_scale_and_others_have_their_own(fields):
    skin = fields()
    power = only("power", skin)
    weight = point_areas(skin)
    one, three = np.linspace(0, 1, weight.size), np.linspace(0, 3, weight.size)
    assert scales(power, [one, three], weight) == [(0, 3), (0, 3)]
    assert scales(power, [one, 100 * one], weight) == [(0, 1), (0, 100)]


def test_signed_scales_are_centred_on_zero(fields):
    skin = fields()
    quantity = only("sensitivity-Rs", skin)
    values = np.linspace(-1, 3, skin.x.shape[1])
    assert scales(quantity, [values], point_areas(skin)) == [(-3, 3)]


def test_a_peak_at_the_end_of_a_foil_does_not_darken_all_else(fields):
    skin = fields()
    values = np.linspace(0, 1, skin.x.shape[1])
    values[3] = 1e3
    ((low, high),) = scales(only("current", skin), [values], point_areas(skin))
    assert low == 0 and 0.9 < high <= 1


def test_phases_fill_the_scale_unless_they_go_around(fields):
    skin = fields()
    phase, weight = only("phase", skin), point_areas(skin)
    values = np.linspace(-60, 0, weight.size)
    assert scales(phase, [values], weight) == [(-60, 0)]
    assert scales(phase, [3 * values], weight) == [(-180, 0)]
    assert scales(phase, [np.linspace(-179, 179, weight.size)], weight) == [(-180, 180)]


def test_few_degrees_are_not_lost_on_the_scale_of_many(fields):
    skin = fields()
    phase, weight = only("phase", skin), point_areas(skin)
    values = np.linspace(-1, 0, weight.size)
    assert scales(phase, [values, 4 * values], weight) == [(-4, 0), (-4, 0)]
    assert scales(phase, [values, 120 * values], weight) == [(-1, 0), (-120, 0)]


@pytest.mark.parametrize(
    ("low", "high", "text"),
    [(0.99983, 1.0, "0.99983 to 1.00000 V"), (-20.6, 0.0, "−21 to 0 V"), (0, 53.4, "0 to 53 V")],
)
def test_the_ends_of_a_scale_are_distinguished(low, high, text):
    assert span_text(low, high, "V") == text


def test_frames_of_other_scales_say_theirs(fields):
    skin = fields([1e3, 1e5])
    drawn = surface(skin)
    one, other = at_frequencies(only("phase", skin), skin, drawn, [0, 1])
    assert "colours: −1.3 to 0.0 degrees" in one.note and one.note != other.note
    alike = at_frequencies(only("potential", skin), skin, drawn, [0, 1])
    assert not any("colours" in each.note for each in alike)
