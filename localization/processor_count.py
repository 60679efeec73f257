"""Number of physical processor cores for scikit-learn's neighbour searches."""

import warnings
from contextlib import redirect_stderr
from functools import cache
from io import StringIO

from joblib import cpu_count


@cache
def physical_cpu_count() -> int:
    """Number of physical cores, or of logical ones if the physical number is unknown.

    joblib prints a warning and a traceback if it is the first to find that `lscpu` is missing, and
    caches the number. scikit-learn then uses the cached number.
    """
    with warnings.catch_warnings(), redirect_stderr(StringIO()):
        warnings.simplefilter("ignore", UserWarning)
        return cpu_count(only_physical_cores=True)
