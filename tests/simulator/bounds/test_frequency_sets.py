"""Reference sets of frequencies, and bands."""

import numpy as np
import pytest
from rcskin.simulator.bounds.frequency_sets import chosen_band, equation_6, logarithmic
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError


def test_equation_6_gives_the_papers_frequencies():
    for n, paper in ((3, [707, 1592, 6367]), (5, [707, 1105, 1965, 4421, 17685])):
        scene = load_scene("strip-1x5")
        np.testing.assert_allclose(
            equation_6(scene.parts.skin, scene.parts.setup, n),
            paper,
            atol=1,
        )


def test_one_frequency_by_log_spacing_is_the_middle_of_the_band():
    assert logarithmic((1e2, 1e4), 1).tolist() == [1000.0]
    np.testing.assert_allclose(logarithmic((1e2, 1e4), 3), [100, 1000, 10000])


def test_a_missing_end_of_a_band_is_that_of_the_scene(noisy_strip):
    low, high = noisy_strip.frequencies[[0, -1]]
    middle = float(low + high) / 2
    assert chosen_band(f"{middle!r}:", noisy_strip.parts.setup) == (middle, high)
    assert chosen_band(f":{middle!r}", noisy_strip.parts.setup) == (low, middle)
    assert (
        chosen_band(None, noisy_strip.parts.setup)
        == chosen_band(":", noisy_strip.parts.setup)
        == (low, high)
    )


@pytest.mark.parametrize("text", ["1e3", "2e3:1e3", "0:1e3", "a:b", "1e3:nan"])
def test_an_invalid_band_is_refused(noisy_strip, text):
    with pytest.raises(InputError, match="`band` must be LOW:HIGH"):
        chosen_band(text, noisy_strip.parts.setup)
