"""Names of the extra `torch` where PyTorch is not installed."""

import pytest
import rcskin
from rcskin.simulator.sweeps import InputError, optional_packages


@pytest.mark.parametrize("name", ["SkinModule", "SweepStream"])
def test_the_extra_is_named_in_one_line(name, monkeypatch):
    monkeypatch.setattr(optional_packages, "find_spec", lambda library: None)
    with pytest.raises(InputError) as missing:
        getattr(rcskin, name)
    assert str(missing.value) == f"rcskin.{name}: needs torch: pip install 'rcskin[torch]'"
