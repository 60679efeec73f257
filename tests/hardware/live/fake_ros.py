"""A fake ROS 2 of a few lines: `rclpy` that keeps what is published, and messages by definition.

Its messages come from the definitions of ROS 2 Jazzy that the package rosbags holds, and refuse
what those that ROS 2 generates for Python refuse: other names, and values of another type.
"""

import array
import sys
from types import ModuleType, SimpleNamespace

import numpy as np
from rcskin.simulator.sweeps.ros_messages import READINGS, TOUCH, definition
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

STORE = get_typestore(Stores.ROS2_JAZZY)
for name in (READINGS, TOUCH):
    STORE.register({name: get_types_from_msg(definition(name), name)[name]})
PLAIN = {"string": str, "bool": bool, "byte": bytes, "float32": float, "float64": float}
PACKAGES = ("std_msgs", "geometry_msgs", "sensor_msgs", "diagnostic_msgs")


class Message:
    """A message of the type `kind`, made with the default of each field."""

    kind = ""

    def __init__(self):
        for name, (node, of) in self.fields().items():
            object.__setattr__(self, name, _default(node, of))

    def fields(self):
        return dict(STORE.fielddefs[self.kind][1])

    def __setattr__(self, name, value):
        node, of = self.fields()[name]
        if node == Nodetype.SEQUENCE or node == Nodetype.ARRAY:
            of, count = of
            assert isinstance(value, list | array.array | np.ndarray), name
            assert node == Nodetype.SEQUENCE or len(value) == count, name
            assert all(_suits(each, *of) for each in value), name
        else:
            assert _suits(value, node, of), (name, value)
        object.__setattr__(self, name, value)


def _suits(value, node, of):
    if node == Nodetype.NAME:
        return value.kind == of
    return isinstance(value, PLAIN.get(of[0], int)) and (of[0] != "byte" or len(value) == 1)


def _default(node, of):
    if node == Nodetype.NAME:
        return type(of, (Message,), {"kind": of})()
    if node == Nodetype.BASE:
        return b"\0" if of[0] == "byte" else PLAIN.get(of[0], int)()
    return []


class Node:
    """Keeps the messages of each topic."""

    def __init__(self, name, namespace):
        self.name, self.namespace = name, f"/{namespace.strip('/')}"
        self.parameters, self.published, self.kinds, self.alive = {}, {}, {}, True
        self.nanoseconds = 2_000_000_000

    def get_namespace(self):
        return self.namespace

    def get_fully_qualified_name(self):
        return f"{self.namespace}/{self.name}"

    def declare_parameter(self, name, value):
        self.parameters[name] = value

    def get_parameter(self, name):
        return SimpleNamespace(value=self.parameters[name])

    def get_clock(self):
        return SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=self.nanoseconds))

    def create_publisher(self, message, topic, depth):
        topic = topic if topic.startswith("/") else f"{self.namespace}/{topic}"
        kept = self.published[topic] = []
        self.kinds[topic] = message.kind

        def publish(content):
            assert content.kind == message.kind and self.alive
            kept.append(content)

        return SimpleNamespace(publish=publish)

    def destroy_node(self):
        self.alive = False


class Rclpy(ModuleType):
    """`rclpy`: its nodes, and True in `runs` between `init` and `try_shutdown`."""

    def __init__(self):
        super().__init__("rclpy")
        self.nodes, self.runs, self.spins = [], False, 0

    def init(self, *, args, signal_handler_options):
        assert args == [] and signal_handler_options == "NO"
        self.runs = True

    def create_node(self, name, *, namespace):
        self.nodes.append(Node(name, namespace))
        return self.nodes[-1]

    def spin_once(self, node, *, timeout_sec):
        assert timeout_sec == 0 and self.runs
        self.spins += 1

    def try_shutdown(self):
        self.runs = False


def install(monkeypatch, *, own_messages=True):
    """Puts the fake `rclpy` and its messages among the modules, and returns `rclpy`."""
    rclpy = Rclpy()
    modules = {"rclpy": rclpy, "rclpy.signals": ModuleType("rclpy.signals")}
    modules["rclpy.signals"].SignalHandlerOptions = SimpleNamespace(NO="NO")
    for package in (*PACKAGES, *(["rcskin_msgs"] if own_messages else [])):
        messages = modules[f"{package}.msg"] = ModuleType(f"{package}.msg")
        modules[package] = ModuleType(package)
        for kind in STORE.fielddefs:
            if kind.startswith(f"{package}/msg/"):
                own = kind.rpartition("/")[2]
                setattr(messages, own, type(own, (Message,), {"kind": kind}))
    for name, module in modules.items():
        monkeypatch.setitem(sys.modules, name, module)
    return rclpy
