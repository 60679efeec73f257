"""A skin on a robot in a physics engine: its mounting, its contacts and its readings."""
