"""The reproduction of Sonar, Yuen, Kramer-Bottiglio and Paik, "An Any-Resolution Distributed
Pressure Localization Scheme Using a Capacitive Soft Sensor Skin": its six devices, its figures, its
numbers beside ours."""
