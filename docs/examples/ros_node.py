"""Publishes the answers of `rcskin live` in ROS 2: a node to copy and change.

Run: rcskin live --model column.npz --resource METER | python3 docs/examples/ros_node.py /skin

It reads the lines that `rcskin live` writes into a pipe, so that it needs ROS 2 and nothing else:
rcskin may run in another Python. `touch` is the answer in words, `probability` that of the answer,
NaN if it has none. No ROS 2 was at hand when this was written.
"""

import sys

import rclpy
from std_msgs.msg import Float32, String

QUEUE = 10
"""Messages that are kept for a slow subscriber."""


def main(namespace: str) -> None:
    """Publishes each line of standard input until it ends."""
    rclpy.init()
    node = rclpy.create_node("rcskin", namespace=namespace)
    touch = node.create_publisher(String, "touch", QUEUE)
    probability = node.create_publisher(Float32, "probability", QUEUE)
    try:
        for line in sys.stdin:
            _, answer, likely, _ = line.rstrip("\n").split("\t")
            touch.publish(String(data=answer))
            probability.publish(Float32(data=float(likely or "nan")))
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "")
