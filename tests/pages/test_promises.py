"""What the pages promise stands there, beside the name of the test that holds it."""

import re

import pytest

from .reading import ROOT, prose

SWEEPS, DATA, MODELS = "tests/simulator/sweeps/", "tests/simulator/dataset/", "tests/localization/"
PROMISES = {
    "docs/reference/files.md": {
        "`rcskin.read` opens each format as an": (
            f"{SWEEPS}test_files.py::test_numbers_are_read_back_to_the_same_bits"
        ),
        "A CSV holds sessions and times in columns.": (
            "tests/hardware/record/test_sessions.py"
            "::test_a_csv_of_a_recording_holds_what_its_netcdf_does"
        ),
        "Every file carries checksums": (
            f"{SWEEPS}test_spoilt.py::test_a_spoilt_file_is_refused_or_gives_the_same_bits"
        ),
        "A file that was cut off or damaged is refused in one line.": (
            f"{SWEEPS}test_spoilt.py::test_a_spoilt_file_is_refused_or_gives_the_same_bits"
        ),
        "If you change a CSV on purpose, delete its lines": (
            f"{SWEEPS}test_spoilt.py"
            "::test_a_csv_changed_on_purpose_is_read_without_the_lines_of_its_checksum"
        ),
        "Cp must follow from Rs and X.": (
            f"{SWEEPS}test_files.py::test_bad_tables_are_reported_with_file_and_line"
        ),
        "`rcskin check` compares the three in every file.": (
            f"{SWEEPS}test_spoilt.py::test_check_compares_Cp_with_Rs_and_X"
        ),
        "They are in double precision if `display_digits` is larger.": (
            f"{DATA}test_generate.py"
            "::test_more_digits_than_single_precision_keeps_are_stored_in_double"
        ),
        "Sweep k depends on the seed and on k only.": (
            f"{DATA}test_generate.py"
            "::test_a_sweep_depends_neither_on_how_many_there_are_nor_on_blocks"
        ),
        "The bytes depend on scene, number of sweeps, seed, tolerance and version only": (
            f"{DATA}test_generate.py::test_any_number_of_processes_gives_the_same_bytes"
        ),
        "CSV has one line for each sweep, interface and frequency.": (
            f"{DATA}exports/test_tables.py::test_csv_is_read_back_as_the_same_sweeps"
        ),
        "Parquet has one row for each sweep": (
            f"{DATA}exports/test_tables.py::test_parquet_has_one_row_a_sweep"
        ),
        "NetCDF keeps everything.": (f"{DATA}exports/test_tables.py::test_netcdf_keeps_everything"),
        "A model file contains no code.": (
            f"{MODELS}model/test_localizer_file.py"
            "::test_a_file_tampered_to_build_another_type_is_refused"
        ),
        "A note names versions that differ from yours.": (
            f"{MODELS}model/test_localizer_model.py::test_a_model_knows_what_it_was_trained_on"
        ),
        "A file of an older layout is refused": (
            f"{MODELS}model/test_localizer_file.py"
            "::test_a_model_of_an_earlier_version_names_what_to_take"
        ),
        "A model refuses sweeps of another skin": (
            f"{MODELS}test_same_skin.py::test_sweeps_of_another_skin_are_refused_and_insisted_on"
        ),
        "| a file, or a folder of data | refused, unless `--overwrite` is given": (
            f"{SWEEPS}test_writing.py::test_what_exists_is_replaced_on_demand_only"
        ),
        "| measured sweeps | refused, unless `--overwrite-measured` is given": (
            f"{SWEEPS}test_writing.py::test_measured_sweeps_need_a_demand_of_their_own"
        ),
        "| a `.nc`, `.csv` or `.zarr` that is damaged | refused": (
            f"{SWEEPS}test_writing.py::test_damage_makes_measured_sweeps_no_easier_to_lose"
        ),
        "nothing is computed, and a line says so; `--overwrite` makes it anew": (
            f"{DATA}test_dataset_command.py::test_a_complete_data_set_is_made_anew_on_demand_only"
        ),
        "| a folder that `export --format lerobot` or `hugging-face` did not write | refused": (
            f"{DATA}exports/test_refusals.py::test_no_option_replaces_a_folder_of_other_files"
        ),
        "A command looks before it computes.": (
            f"{SWEEPS}test_writing.py::test_a_refusal_does_not_look_into_the_file"
        ),
        "If a file appears while the command computes, it stays.": (
            f"{SWEEPS}test_writing.py"
            "::test_what_appears_meanwhile_is_kept_and_so_is_what_is_finished"
        ),
        "They also count as measured if they do not hold the tolerance of a simulation.": (
            f"{SWEEPS}test_writing.py::test_measured_sweeps_need_a_demand_of_their_own"
        ),
        "that was interrupted goes on with the same command.": (
            f"{DATA}test_resume.py::test_killed_several_times_it_ends_with_the_same_bytes"
        ),
        "the functions that write take `overwrite=True`": (
            "tests/front/test_front_door.py::test_what_exists_is_replaced_on_demand_only"
        ),
        "A file is written completely or not at all.": (
            f"{SWEEPS}test_writing.py::test_it_appears_whole_or_not_at_all"
        ),
        "It gets its name when all of it is on the disk.": (
            f"{SWEEPS}test_writing.py::test_what_is_renamed_is_on_the_disk_first_and_its_name_after"
        ),
        "A symbolic link stays, and its target is replaced.": (
            f"{SWEEPS}test_writing.py::test_a_symbolic_link_stays_and_its_target_is_replaced"
        ),
        "If another program holds the target open (Windows), the finished result stays": (
            f"{SWEEPS}test_writing.py"
            "::test_what_is_finished_stays_where_the_target_is_open_elsewhere"
        ),
        "deletes unfinished files, `.rcskin-*`, of its folder that nobody changed for a day": (
            f"{SWEEPS}test_writing.py"
            "::test_what_nobody_changed_for_a_day_is_cleared_and_nothing_else"
        ),
        "the next command that looks for that `.zarr` puts the earlier one back.": (
            f"{SWEEPS}test_writing.py"
            "::test_a_folder_whose_writer_was_killed_between_two_renames_is_put_back"
        ),
        "compiled kernels; a damaged file is made again": (
            "tests/simulator/test_kernel_cache.py"
            "::test_kernels_go_into_the_users_cache_and_a_spoilt_one_is_made_again"
        ),
        "Nothing is written into the installation.": (
            "tests/simulator/test_kernel_cache.py"
            "::test_kernels_go_into_the_users_cache_and_a_spoilt_one_is_made_again"
        ),
        "If a folder cannot be written, each process compiles its own kernels.": (
            "tests/simulator/test_kernel_cache.py::test_a_cache_that_cannot_be_written_is_done_without"
        ),
        "| 1 | any other failure: a tolerance that cannot be kept": (
            "tests/simulator/test_cli.py"
            "::test_a_tolerance_out_of_reach_ends_with_code_1_and_no_file"
        ),
        "a broken law (`check`)": (
            "tests/simulator/check/test_command.py"
            "::test_a_broken_law_ends_with_code_1_and_names_sweep_and_frequencies"
        ),
        "no answer of a meter (`live`)": (
            "tests/hardware/live/test_command.py::test_an_unplugged_meter_is_given_up_with_code_1"
        ),
        "| 2 | an input or option is refused, in one line |": (
            "tests/simulator/test_cli.py::test_bad_input_ends_with_one_line_and_code_2"
        ),
        "| 3 | done, but the meter did not confirm that a setting was put back |": (
            "tests/hardware/record/test_left_as_found.py"
            "::test_a_good_recording_that_leaves_it_changed_says_so_in_its_code"
        ),
        "ended by a signal: 130 by Ctrl-C": (
            "tests/simulator/test_interrupt.py"
            "::test_work_that_goes_on_is_ended_and_leaves_nothing_unfinished"
        ),
    }
}
"""By page: what it promises, or the beginning, and the test."""


@pytest.mark.parametrize(
    ("page", "promise", "test"),
    [(page, *each) for page, promises in PROMISES.items() for each in promises.items()],
)
def test_a_promise_stands_on_its_page_and_has_a_test(page, promise, test):
    assert promise in " ".join(prose(page).split())
    file, _, name = test.partition("::")
    assert re.search(rf"^def {name}\(", (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE)
