"""The repository is the package: what lies at its top is installed under the one name `rcskin`."""

from setuptools import find_packages, setup

ROOMS = find_packages(include=["simulator*", "localization*", "hardware*"])

setup(
    packages=["rcskin", *(f"rcskin.{room}" for room in ROOMS)],
    package_dir={"rcskin": "."},
    script_name="setup.py",
)
