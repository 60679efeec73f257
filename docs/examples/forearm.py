"""An arm with a skin around its forearm leans on a ball, and turns:
python docs/examples/forearm.py -o forearm.gif"""

import numpy as np
from robot_example import RobotExample, main

XML = """
<mujoco>
  <option timestep="0.002" cone="elliptic"/>
  <visual><global offwidth="640" offheight="480"/></visual>
  <worldbody>
    <light pos="0.2 -0.4 0.6" dir="-0.3 0.6 -1"/>
    <camera name="film" pos="-.3 -.32 .28" xyaxes=".73 -.68 0 .36 .39 .85"/>
    <geom type="plane" size=".5 .5 .01" pos="0 0 -.15" rgba=".9 .9 .9 1"/>
    <geom name="ball" type="sphere" size=".012" pos="0 0 .052" friction=".1" rgba=".9 .5 .2 1"/>
    <geom type="capsule" fromto="0 0 .064 0 0 .12" size=".004" rgba=".5 .5 .5 1"
          contype="0" conaffinity="0"/>
    <body name="upper arm" pos="0 .25 -.002">
      <joint name="elbow" type="hinge" axis="1 0 0" damping=".05"/>
      <joint name="reach" type="slide" axis="0 1 0" damping="2"/>
      <geom type="sphere" size=".03" mass=".1" rgba=".3 .3 .35 1"/>
      <body name="forearm" pos="0 -.25 0">
        <joint name="turn" type="hinge" axis="0 1 0" damping=".02"/>
        <geom type="cylinder" fromto="0 -.06 0 0 .2 0" size=".04" mass=".1" friction=".1"
              rgba=".3 .3 .35 1"/>
        <site name="forearm" pos="0 0 .04" type="box" size=".004 .04 .0008" rgba=".2 .6 .9 .8"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor joint="elbow"/>
    <position joint="reach" kp="200" kv="10"/>
    <position joint="turn" kp="3" kv=".1"/>
  </actuator>
</mujoco>
"""


def control(data, time):
    """Lean upwards on the ball by about 1.5 N, while the forearm turns and reaches."""
    phase = 2 * np.pi * time / 4
    weight = 0.1 * 9.81 * 0.18
    data.ctrl[:] = -(weight + 1.5 * 0.25), 0.02 * np.sin(2 * phase), np.sin(phase)


SKIN = {
    "name": "forearm",
    "description": "skin around a robot's forearm, read by a multisine",
    "skin.length": 0.120,  # m
    "skin.shape": {"kind": "cylinder", "radius": 0.040},  # m, that of the built-in mug
    "pixels.columns": 6,
}
FOREARM = RobotExample(XML, ("forearm",), control, changes=SKIN)

if __name__ == "__main__":
    main(FOREARM)
