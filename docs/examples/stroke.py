"""A finger strokes a flat skin: python docs/examples/stroke.py -o stroke.gif"""

import numpy as np
from robot_example import RobotExample, main

XML = """
<mujoco>
  <option timestep="0.002"/>
  <visual><global offwidth="640" offheight="480"/></visual>
  <worldbody>
    <light pos="0.1 -0.2 0.5" dir="-0.2 0.4 -1"/>
    <camera name="film" pos="0.0 -0.16 0.12" xyaxes="1 0 0 0 0.6 0.8"/>
    <geom type="plane" size=".3 .3 .01" pos="0 0 -.02" rgba=".9 .9 .9 1"/>
    <body name="palm">
      <geom type="box" size=".045 .045 .01" pos="0 0 -.01" rgba=".3 .3 .35 1" friction=".3"/>
      <site name="palm" type="box" size=".04 .04 .0005" rgba=".2 .6 .9 .6"/>
    </body>
    <body name="finger" pos="0 0 .009">
      <joint name="x" type="slide" axis="1 0 0" damping=".1"/>
      <joint name="y" type="slide" axis="0 1 0" damping=".1"/>
      <joint name="z" type="slide" axis="0 0 1" damping="2"/>
      <geom type="capsule" fromto="0 0 0 0 .01 .04" size=".008" mass=".05" rgba=".9 .7 .6 1"/>
    </body>
  </worldbody>
  <actuator>
    <position name="x" joint="x" kp="60" kv="3"/>
    <position name="y" joint="y" kp="60" kv="3"/>
    <motor name="push" joint="z"/>
  </actuator>
</mujoco>
"""


def control(data, time):
    """A figure of eight, pressed by 1 N and the weight."""
    phase = 2 * np.pi * time / 4
    data.ctrl[:] = 0.025 * np.sin(phase), 0.025 * np.sin(2 * phase), -1.0


STROKE = RobotExample(XML, ("palm",), control)

if __name__ == "__main__":
    main(STROKE)
