"""How many cores scikit-learn's searches for neighbours are given."""

import warnings
from contextlib import redirect_stderr
from functools import cache
from io import StringIO

from joblib import cpu_count


@cache
def physical_cpu_count() -> int:
    """Physical cores, or logical ones on a machine that tells of no others.

    joblib, which scikit-learn asks, prints a warning and a traceback where it is the first to find
    that `lscpu` is missing, and remembers the answer.
    """
    with warnings.catch_warnings(), redirect_stderr(StringIO()):
        warnings.simplefilter("ignore", UserWarning)
        return cpu_count(only_physical_cores=True)
