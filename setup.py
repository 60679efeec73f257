"""The repository is the package: what lies at its top is installed under the one name `rcskin`.

`pyproject.toml` can map that name to a folder, but the packages it finds keep their names from the
top: it would have to list every one.
"""

from tempfile import TemporaryDirectory

from setuptools import find_packages, setup

ROOMS = find_packages(include=["simulator*", "localization*", "hardware*"])

with TemporaryDirectory(ignore_cleanup_errors=True) as scratch:
    setup(
        packages=["rcskin", *(f"rcskin.{room}" for room in ROOMS)],
        package_dir={"rcskin": "."},
        script_name="setup.py",
        options={  # a clone stays as it was: a `build` left there would go into the next wheel
            "build": {"build_base": scratch},
            "egg_info": {"egg_base": scratch},
        },
    )
