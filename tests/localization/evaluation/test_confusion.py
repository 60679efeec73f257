import numpy as np
import pytest
from rcskin.localization.evaluation.confusion import Confusion, compare, write_csv
from rcskin.simulator.sweeps import InputError

THREE = Confusion((0, 1, 2), np.array([[4, 0, 0], [1, 2, 1], [0, 1, 1]]))


def test_accuracy_follows_from_the_counts():
    assert (THREE.correct, THREE.total) == (7, 10)
    assert THREE.accuracy == 0.7


def test_targets_run_along_the_first_axis_and_outputs_along_the_second():
    confusion = compare(np.array([1, 1, 2, 0]), np.array([1, 2, 2, 0]))
    assert confusion.labels == (0, 1, 2)
    assert confusion.counts.tolist() == [[1, 0, 0], [0, 1, 1], [0, 0, 1]]


def test_pixels_are_ordered_by_number_not_by_letter():
    pixels = np.array(["10,1", "2,3", "2,12", "0,0"])
    assert compare(pixels, pixels).labels == ("0,0", "2,3", "2,12", "10,1")


def test_the_table_holds_each_pair_of_classes_and_reads_back(tmp_path):
    path = tmp_path / "confusion.csv"
    write_csv(THREE, path)
    first, *lines = path.read_text(encoding="utf-8").splitlines()
    assert first == "target,output,count"
    rows = [tuple(int(cell) for cell in line.split(",")) for line in lines]
    assert rows == THREE.table()
    assert sum(count for *_, count in rows) == THREE.total


def test_pixels_are_quoted_in_the_table(tmp_path):
    path = tmp_path / "confusion.csv"
    write_csv(compare(np.array(["1,2", "0,0"]), np.array(["1,2", "1,2"])), path)
    assert path.read_text(encoding="utf-8").splitlines()[2] == '"0,0","1,2",1'


@pytest.mark.parametrize(
    ("name", "message"), [("a.txt", "must end in .csv"), ("no/a.csv", "does not exist")]
)
def test_a_path_that_cannot_be_written_is_refused(tmp_path, name, message):
    with pytest.raises(InputError, match=message):
        write_csv(THREE, tmp_path / name)
