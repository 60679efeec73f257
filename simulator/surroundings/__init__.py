"""Static field around a skin: its sheets' charges in 3D, with foam and bodies.

At the frequencies of a meter the field outside the sheets is electrostatic, so it is solved once
for each geometry, for any sheet resistance, press and frequency.
"""
