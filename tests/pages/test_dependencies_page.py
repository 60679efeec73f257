"""The page of dependencies names each one that the project declares, with a reason."""

from rcskin.docs.dependencies import PAGE, reasons, requirements


def test_each_dependency_has_a_reason_and_somebody_who_would_miss_it():
    declared = {each.name for own in requirements().values() for each in own}
    assert set(reasons()) == declared
    assert all(len(cells) == 2 and all(cells) for cells in reasons().values())


def test_the_page_lists_each_dependency_from_the_version_that_is_declared():
    text = PAGE.read_text(encoding="utf-8")
    for own in requirements().values():
        for each in own:
            lowest = str(each.specifier).removeprefix(">=")
            assert f"| `{each.name}` | {lowest} |" in text or _is_higher(each, text)


def _is_higher(requirement, text):
    """True if the page lists a lower version, which another extra allows."""
    row = next(line for line in text.splitlines() if line.startswith(f"| `{requirement.name}`"))
    return row.split("|")[2].strip() not in requirement.specifier
