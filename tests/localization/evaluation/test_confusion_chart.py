import io

import numpy as np
import pytest
from matplotlib.figure import Figure
from rcskin.localization.evaluation.confusion import Confusion
from rcskin.localization.evaluation.confusion_chart import draw_confusion

CONFUSION = Confusion((0, 1, 5), np.array([[6, 0, 0], [1, 4, 1], [0, 0, 6]]))


@pytest.fixture
def axes():
    axes = Figure().subplots()
    draw_confusion(axes, CONFUSION)
    return axes


def cell(axes, target, output):
    """The text and the colour at a place given by the positions of its classes."""
    (text,) = [text for text in axes.texts if text.get_position() == (target, output)]
    return text.get_text(), axes.images[0].get_array()[output, target]


def test_targets_run_to_the_right_and_outputs_downwards(axes):
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("Target class", "Output class")
    assert [label.get_text() for label in axes.get_xticklabels()] == ["none", "1", "5"]
    assert axes.yaxis_inverted()
    assert cell(axes, target=1, output=0)[0] == "1\n5.6 %"
    assert len(axes.texts) == np.count_nonzero(CONFUSION.counts)


def test_the_title_states_the_accuracy(axes):
    assert axes.get_title() == "Accuracy 88.9 % (16 of 18)"


def test_right_is_blue_wrong_is_orange_and_never_is_white(axes):
    red, _, blue = cell(axes, target=1, output=1)[1]
    assert blue > red
    red, _, blue = cell(axes, target=1, output=0)[1]
    assert red > blue
    np.testing.assert_array_equal(axes.images[0].get_array()[2, 0], 1)


def test_a_class_without_sweeps_is_drawn_empty():
    axes = Figure().subplots()
    draw_confusion(axes, Confusion((0, 1), np.array([[0, 0], [1, 3]])))
    assert len(axes.texts) == 2
    np.testing.assert_array_equal(axes.images[0].get_array()[:, 0], 1)


def test_it_can_be_printed(axes):
    axes.figure.savefig(io.BytesIO(), format="pdf")


@pytest.mark.parametrize("classes", [2, 13, 36])
def test_what_stands_in_a_cell_fits_into_it(classes):
    random = np.random.default_rng(0)
    counts = random.integers(0, 130, (classes, classes)) * (random.random((classes, classes)) < 0.3)
    figure = Figure(figsize=2 * [max(4.5, min(14, 0.55 * classes))], layout="constrained")
    axes = figure.subplots()
    draw_confusion(axes, Confusion(tuple(range(classes)), counts))
    figure.draw_without_rendering()
    side = axes.bbox.width / classes
    extents = [text.get_window_extent() for text in axes.texts]
    assert extents
    assert max(max(extent.width, extent.height) for extent in extents) < side
    assert min(text.get_fontsize() for text in axes.texts) >= 6
