"""A gripper holds a ball: python docs/examples/gripper.py -o gripper.gif"""

import numpy as np
from robot_example import RobotExample, main

XML = """
<mujoco>
  <option timestep="0.002" cone="elliptic" impratio="10"/>
  <visual><global offwidth="640" offheight="480"/></visual>
  <default><geom friction="1.5 .005 .0001"/></default>
  <worldbody>
    <light pos="0.1 -0.3 0.5" dir="-0.2 0.5 -1"/>
    <camera name="film" pos="0 -.24 .07" xyaxes="1 0 0 0 .25 1"/>
    <geom type="plane" size=".3 .3 .01" pos="0 0 -.08" rgba=".9 .9 .9 1"/>
    <body name="left jaw" pos="-.027 0 0">
      <joint name="left" type="slide" axis="1 0 0" damping="5"/>
      <joint name="left up" type="slide" axis="0 0 1" damping="5"/>
      <geom type="box" size=".006 .045 .045" mass=".1" rgba=".3 .3 .35 1"/>
      <site name="left" pos=".006 0 0" xyaxes="0 1 0 0 0 1" type="box" size=".04 .04 .0005"
            rgba=".2 .6 .9 .6"/>
    </body>
    <body name="right jaw" pos=".027 0 0">
      <joint name="right" type="slide" axis="-1 0 0" damping="5"/>
      <joint name="right up" type="slide" axis="0 0 1" damping="5"/>
      <geom type="box" size=".006 .045 .045" mass=".1" rgba=".3 .3 .35 1"/>
      <site name="right" pos="-.006 0 0" xyaxes="0 -1 0 0 0 1" type="box" size=".04 .04 .0005"
            rgba=".2 .6 .9 .6"/>
    </body>
    <body name="ball" pos="0 .012 0">
      <freejoint/>
      <geom type="sphere" size=".02" mass=".03" rgba=".9 .5 .2 1"/>
    </body>
  </worldbody>
  <actuator>
    <motor joint="left"/>
    <motor joint="right"/>
    <position joint="left up" kp="400" kv="20"/>
    <position joint="right up" kp="400" kv="20"/>
  </actuator>
</mujoco>
"""


def control(data, time):
    """Hold by 2 N; the jaws move against each other, so that the ball rolls between them."""
    shift = 0.03 * np.sin(2 * np.pi * time / 4)
    data.ctrl[:] = 2.0, 2.0, shift, -shift


GRIPPER = RobotExample(XML, ("left", "right"), control)

if __name__ == "__main__":
    main(GRIPPER)
