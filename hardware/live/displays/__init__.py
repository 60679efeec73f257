"""Displays of a live session: terminal, pipe, page and ROS 2."""
