"""Maps: what factors they are where, how random ones vary, how well grids stand for smooth ones."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.scene.factor_maps import (
    SHORTEST,
    Constant,
    Gradient,
    Grid,
    Random,
    random_field,
)

SIDES = (0.12, 0.08)


def places(columns=41, rows=31):
    """On an even grid over the skin, its edges included; shape (2, row, column)."""
    x, y = np.linspace(0, SIDES[0], columns), np.linspace(0, SIDES[1], rows)
    return np.stack(np.meshgrid(x, y))


def test_a_gradient_rises_by_so_much_from_edge_to_edge():
    of_place = Gradient(x=0.4, y=-0.2, middle=1.5)
    corners = np.array([[0.0, 0.12, 0.0, 0.12, 0.06], [0.0, 0.0, 0.08, 0.08, 0.04]])
    expected = [1.4, 1.8, 1.2, 1.6, 1.5]
    np.testing.assert_allclose(of_place.factors(corners, SIDES), expected, rtol=1e-12)
    assert of_place.uniform is None
    assert Gradient(middle=2.0).uniform == 2.0


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(0.1, 2))
def test_a_gradient_that_is_accepted_is_positive_everywhere(x, y, middle):
    try:
        of_place = Gradient(x=x, y=y, middle=middle)
    except ValueError:
        assert abs(x) + abs(y) >= 2 * middle
    else:
        assert of_place.factors(places(), SIDES).min() > 0


@pytest.mark.parametrize("apart", [0.0, 0.5, 1.0, 2.0])
def test_random_fields_correlate_by_their_kernel(apart):
    """Means over 4000 seeds at places that are so many correlation lengths apart."""
    length = 0.02
    step = apart * length / np.sqrt(2)
    x = np.array([[0.01, 0.01 + step], [0.02, 0.02 + step]])
    first, second = np.array([random_field(x, SIDES, length, seed) for seed in range(4000)]).T
    assert np.mean(first * second) == pytest.approx(np.exp(-(apart**2) / 2), abs=0.06)
    assert np.mean(first) == pytest.approx(0, abs=0.06)
    assert np.mean(first**2) == pytest.approx(1, abs=0.08)


def test_far_edges_of_a_random_field_know_nothing_of_each_other():
    x = np.array([[0.0, 0.12], [0.04, 0.04]])
    first, second = np.array([random_field(x, SIDES, 0.01, seed) for seed in range(2000)]).T
    assert np.mean(first * second) == pytest.approx(0, abs=0.06)


@pytest.mark.parametrize("distribution", ["lognormal", "normal"])
def test_random_maps_have_mean_one_and_their_deviation(distribution):
    drawn = [
        Random(deviation=0.1, correlation_length=0.004, distribution=distribution, seed=seed)
        for seed in range(40)
    ]
    factors = np.array([each.factors(places(), SIDES) for each in drawn])
    assert factors.mean() == pytest.approx(1, abs=0.005)
    assert factors.std() == pytest.approx(0.1, rel=0.03)
    assert factors.min() > 0


def test_a_seed_gives_the_same_map_at_any_places_and_another_one_another():
    one, other = (Random(deviation=0.3, correlation_length=0.01, seed=seed) for seed in (1, 2))
    few, many = places(5, 4), places(9, 7)
    np.testing.assert_array_equal(one.factors(many, SIDES), one.factors(many, SIDES))
    np.testing.assert_allclose(
        one.factors(few, SIDES), one.factors(many, SIDES)[::2, ::2], rtol=1e-12
    )
    assert np.abs(one.factors(few, SIDES) - other.factors(few, SIDES)).max() > 0.1


def test_a_normal_map_that_comes_near_zero_is_refused():
    drawn = Random(deviation=0.3, correlation_length=0.003, distribution="normal", seed=1)
    with pytest.raises(ValueError, match=r"deviation must leave the factor >= 0.05 everywhere"):
        drawn.check(SIDES)
    drawn.model_copy(update={"distribution": "lognormal"}).check(SIDES)
    too_wide = Random(deviation=0.5, correlation_length=0.05, distribution="normal")
    with pytest.raises(ValueError, match=r"deviation must be <= 0.3 for a normal factor, got 0.5"):
        too_wide.check(SIDES)


def test_a_field_finer_than_a_mesh_can_follow_is_refused():
    least = SHORTEST * SIDES[0]
    Random(deviation=0.1, correlation_length=least).check(SIDES)
    with pytest.raises(ValueError, match="correlation_length must be >= 0.0024 m"):
        Random(deviation=0.1, correlation_length=0.99 * least).check(SIDES)


def test_a_grid_is_bilinear_between_values_of_which_the_outer_lie_on_the_edges():
    values = ((1.0, 2.0, 4.0), (3.0, 5.0, 6.0))
    of_place, (length, width) = Grid(values=values), SIDES
    x = np.array(
        [[0, length / 2, length, 0, length, length / 4], [0, 0, 0, width, width, width / 2]]
    )
    expected = [1.0, 2.0, 4.0, 3.0, 6.0, (1 + 2 + 3 + 5) / 4]
    np.testing.assert_allclose(of_place.factors(x, SIDES), expected, rtol=1e-12)
    assert of_place.kinks(SIDES) == ((length / 2,), ())
    assert of_place.shortest(SIDES) == pytest.approx(min(length / 2, width))


def test_grids_of_one_row_or_value_do_not_vary_along_what_they_lack():
    row = Grid(values=((1.0, 3.0),)).factors(places(), SIDES)
    np.testing.assert_array_equal(row, np.broadcast_to(row[:1], row.shape))
    one = Grid(values=((2.5,),))
    np.testing.assert_array_equal(one.factors(places(), SIDES), 2.5)
    assert (one.uniform, one.shortest(SIDES), one.kinks(SIDES)) == (2.5, np.inf, ((), ()))


def test_a_grid_misses_a_smooth_map_by_the_square_of_its_step_up_to_the_edges():
    def smooth(x):
        return 1.5 + np.sin(20 * x[0]) * np.exp(5 * x[1]) / 2

    missed = []
    for count in (9, 17, 33):
        values = tuple(map(tuple, smooth(places(count, count)).tolist()))
        found = Grid(values=values).factors(places(301, 203), SIDES)
        missed.append(np.abs(found - smooth(places(301, 203))).max())
    orders = np.log2(np.divide(missed[:-1], missed[1:]))
    assert (orders > 1.9).all()


def test_constants_are_uniform_without_lines_or_lengths():
    of_place = Constant(value=0.7)
    assert (of_place.uniform, of_place.kinks(SIDES)) == (0.7, ((), ()))
    assert of_place.shortest(SIDES) == np.inf
    np.testing.assert_array_equal(of_place.factors(places(), SIDES), np.full((31, 41), 0.7))


@pytest.mark.parametrize(
    ("kind", "given", "told"),
    [
        (Constant, {"value": 0.0}, "must be from 1e-6 to 1e6 times the nominal value, got 0"),
        (Gradient, {"x": 1.5, "y": 0.6}, r"\|x\| \+ \|y\| < 2, got 2.1"),
        (Grid, {"values": ((1.0, 2.0), (3.0,))}, "must be rows of equally many values"),
        (Grid, {"values": ((1.0, -2.0),)}, "must be from 1e-6 to 1e6"),
        (Grid, {"values": ((1.0,) * 129,)}, "must be at most 128 x 128, got 1 x 129"),
        (Random, {"deviation": -0.1, "correlation_length": 0.1}, "must be from 0 to 1"),
        (Random, {"deviation": 0.1, "correlation_length": 0.0}, "must be from 1e-5 to 1000 m"),
    ],
)
def test_values_out_of_range_are_named(kind, given, told):
    with pytest.raises(ValueError, match=told):
        kind(**given)
