"""Other ways to the impedance of a skin, each written as its user would write it.

One way a file, and each shows one face: `impedance(scene, press, frequencies)` is Z in ohm of the
first interface, shape (frequency,), for frequencies in Hz. All take foils without resistance and a
foam without loss, and one foil on either side of the meter.
"""
