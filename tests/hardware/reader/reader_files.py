"""Files of readers for tests, and a device of two terminals that writes its lines by hand."""

FREQUENCIES = {"left": (1e3, 2e3, 4e3), "bottom": (1e3, 2e3, 4e3)}

COUNTED = """
name = "bench"
format = "csv"
columns = ["n", "t", "port", "f", "r", "x"]
count = "n"
time = "t"
terminal = "port"
frequency = "f"
real = "r"
imaginary = "x"
banner = "READY"
rate = 2000
[[interface]]
name = "left"
label = "A"
[[interface]]
name = "bottom"
label = "B"
"""
"""One line for each reading of two terminals."""

ARRAYS = """
name = "arrays"
format = "json"
lines = "sweeps"
frequency = "khz"
frequency_scale = 1e3
sweep = "id"
phase_unit = "rad"
rate = 200
[[interface]]
name = "left"
magnitude = "a.mag"
phase = "a.phi"
[[interface]]
name = "bottom"
magnitude = "b.mag"
phase = "b.phi"
"""
"""One line for each sweep."""


def true_value(interface, frequency, sweep=0):
    """Rs + jX that the device has, ohm."""
    return complex(1000 + (interface == "bottom") + 10 * sweep, -frequency)


def counted_lines(sweep=0, first=0):
    """Lines of one sweep of COUNTED."""
    lines = []
    for interface, label in (("left", "A"), ("bottom", "B")):
        for frequency in FREQUENCIES[interface]:
            Z = true_value(interface, frequency, sweep)
            n = first + len(lines)
            lines.append(f"{n},{10 * n},{label},{frequency:.0f},{Z.real:.1f},{Z.imag:.1f}")
    return lines
