"""Reproduction of the paper: its six devices, its figures, and its numbers compared with ours.

H. A. Sonar, M. C. Yuen, R. Kramer-Bottiglio, J. Paik, "An Any-Resolution Distributed Pressure
Localization Scheme Using a Capacitive Soft Sensor Skin".
"""
