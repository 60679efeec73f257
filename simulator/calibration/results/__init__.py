"""Results of a fit: estimates with intervals, what they determine, report and chart."""
