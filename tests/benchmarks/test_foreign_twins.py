"""Tables of skins of a three-dimensional solve."""

import numpy as np
import pandas as pd
from rcskin.benchmarks.localization.foreign_twin import summary, table


def answers(scores):
    """Two skins with one effect and one localizer."""
    rows = [{"effect": "all", "way": "SVM", "skin": k, "score": s} for k, s in enumerate(scores)]
    return pd.DataFrame(rows).assign(answered=0.95)


def cell(scores, placed):
    return table(summary(answers(scores), placed), placed)["SVM"].item()


def test_shares_have_a_mean_and_its_standard_error():
    assert cell([0.8, 0.9], placed=False) == "85.0 ± 5.0 (95)"
    assert cell([0.8], placed=False) == "80.0 ± 0.0 (95)"


def test_distances_have_a_median_and_a_range_which_is_infinite_if_a_skin_is_not_answered():
    assert cell([2.0, 3.0, 7.0], placed=True) == "3.00 (2.00 to 7.00) (95)"
    assert cell([2.0, 3.0, np.inf], placed=True) == "3.00 (2.00 to inf) (95)"
