"""Readers that are no meter: devices that send lines of JSON or CSV, such as microcontrollers."""
