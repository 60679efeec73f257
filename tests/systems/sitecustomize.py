"""Python imports this file first of all if `PYTHONPATH` names its folder: see `imitated`."""

import os

if os.environ.get("RCSKIN_TEST_SYSTEM"):
    import imitated

    imitated.imitate(os.environ["RCSKIN_TEST_SYSTEM"])
