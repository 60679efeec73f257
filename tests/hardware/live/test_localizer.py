"""A trained model's classes, probabilities and positions as answers to draw."""

from types import SimpleNamespace

import numpy as np
import pytest
from rcskin.hardware.live.live_localizer import CANNOT_TELL, LiveLocalizer
from rcskin.hardware.live.touch_answer import NOTHING_PRESSED

SWEEP, REST = object(), object()


@pytest.fixture
def localizer():
    """A function that makes one of a model that tells these things, and only of SWEEP and REST."""

    def localizer(target, label, classes=(), probabilities=(), position=None, certain=0.9):
        def told(answer):
            def asked(sweep, rest):
                assert (sweep, rest) == (SWEEP, REST)
                return answer

            return asked

        model = SimpleNamespace(
            target=target,
            classes=classes,
            answers=told(
                SimpleNamespace(
                    labels=np.array([label]),
                    probability=np.array([certain]),
                    chances=np.array([probabilities]),
                )
            ),
            positions=told((np.array([position]), np.array([[3.0, 5.0, 0.1]]))),
            fault_kinds=lambda sweep: np.array([""]),
            regions=told([SimpleNamespace(shade=lambda x, y: (x > 40).astype(float))]),
        )
        return LiveLocalizer(
            model,
            SimpleNamespace(skin=SimpleNamespace(pixels=SimpleNamespace(shape=(2, 3)))),
        )

    return localizer


def test_a_column_has_its_probability_everywhere_in_it(localizer):
    answer = localizer("column", "2", [0, 1, 2, 3], [0.1, 0.1, 0.7, 0.1]).answer(
        SWEEP, REST, 0.0, 0.4
    )
    assert answer.words == "column 2, 70 %"
    assert answer.pixels == pytest.approx(np.array([[0.1, 0.7, 0.1]] * 2))


def test_a_pixel_has_its_own(localizer):
    answer = localizer("pixel", "2,3", ["0,0", "2,3"], [0.25, 0.75]).answer(SWEEP, REST, 0.0, 0.4)
    assert answer.words == "pixel 2,3, 75 %"
    assert answer.pixels == pytest.approx(np.array([[0, 0, 0], [0, 0, 0.75]]))


def test_what_has_no_answer_has_no_probability_but_is_drawn(localizer):
    answer = localizer("column", CANNOT_TELL, [0, 1], [0.5, 0.5]).answer(SWEEP, REST, 0.0, 0.4)
    assert answer.words == CANNOT_TELL
    assert answer.pixels[:, 0] == pytest.approx(0.5)


def test_touches_are_counted_and_nothing_is_drawn(localizer):
    answer = localizer("touches", "2", [0, 1, 2], [0.0, 0.2, 0.8]).answer(SWEEP, REST, 0.0, 0.4)
    assert (answer.words, answer.pixels) == ("2 touches, 80 %", None)


def test_a_position_is_reported_in_mm_with_its_deviation(localizer):
    answer = localizer("position", "1", position=[43.2, 71.8, 2.04]).answer(SWEEP, REST, 0.0, 0.4)
    assert answer.words == "x 43 mm, y 72 mm, strength 2, ± 3.0 x 5.0 mm"
    assert (answer.position, answer.deviation) == ((43.2, 71.8), (3.0, 5.0))
    np.testing.assert_array_equal(answer.region(np.array([10, 50]), np.array([5, 5])), [0, 1])


@pytest.mark.parametrize(
    ("label", "words"), [("0", f"{NOTHING_PRESSED}, 90 %"), (CANNOT_TELL, CANNOT_TELL)]
)
def test_a_model_of_positions_may_have_none_to_answer(localizer, label, words):
    answer = localizer("position", label, position=[1.0, 1.0, 1.0]).answer(SWEEP, REST, 0.0, 0.4)
    assert (answer.words, answer.position) == (words, None)
