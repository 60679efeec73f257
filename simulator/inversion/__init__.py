"""What the localizer inverts by: tables of sweeps, of places and of skins that are not known."""
