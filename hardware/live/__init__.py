"""Live localization: touches are localized while the meter measures."""
