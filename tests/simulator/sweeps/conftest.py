"""Tables of other tools as lines of text, imported or refused."""

import pytest
from rcskin.simulator.sweeps import InputError
from rcskin.simulator.sweeps.importing.grouping import Defaults
from rcskin.simulator.sweeps.imports import import_file


@pytest.fixture
def table(tmp_path):
    """A function that imports a table of some text."""

    def table(*lines, encoding="utf-8", name="some.csv", **defaults):
        (tmp_path / name).write_text("\n".join(lines), encoding=encoding)
        return import_file(tmp_path / name, Defaults(**defaults))

    return table


@pytest.fixture
def refusal(table, tmp_path):
    """A function that gives the one line in which a table of some text is refused."""

    def refusal(*lines):
        with pytest.raises(InputError) as error:
            table(*lines)
        message = str(error.value)
        assert message.startswith(f"{tmp_path / 'some.csv'}: ") and "\n" not in message
        return message

    return refusal
