"""The static field around a skin: charges of its sheets in three dimensions, foam and bodies there.

At the frequencies of a meter the field outside the sheets is that of electrostatics, so it is
solved once for each geometry, whatever the sheets' resistance, the press or the frequency.
"""
