"""How the tests themselves run."""

import joblib


def test_there_is_one_worker_more_than_cores(pytestconfig):
    workers = pytestconfig.hook.pytest_xdist_auto_num_workers(config=pytestconfig)
    assert workers == joblib.cpu_count() + 1
