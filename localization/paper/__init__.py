"""The reproduction of Sonar, Yuen, Kramer-Bottiglio and Paik, "An Any-Resolution Distributed
Pressure Localization Scheme Using a Capacitive Soft Sensor Skin": its six devices and its figures,
and its numbers compared with ours."""
