"""The example of a node of ROS 2, with a substitute for `rclpy`: what it publishes."""

import io
import math
import runpy
import sys
from types import ModuleType, SimpleNamespace

from .reading import ROOT


def test_the_node_publishes_each_answer(monkeypatch):
    published, ended = [], []

    def node(name, namespace):
        def publisher(kind, topic, queue):
            where = f"{namespace}/{topic}"
            return SimpleNamespace(publish=lambda message: published.append((where, message.data)))

        return SimpleNamespace(create_publisher=publisher, destroy_node=lambda: ended.append(name))

    messages = {name: type(name, (SimpleNamespace,), {}) for name in ("String", "Float32")}
    modules = {
        "rclpy": {"init": lambda: None, "create_node": node, "try_shutdown": lambda: None},
        "std_msgs": {},
        "std_msgs.msg": messages,
    }
    for name, content in modules.items():
        module = ModuleType(name)
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, name, module)
    lines = "12:00:01\tcolumn 3\t0.9712\t410.0\n12:00:02\tcannot tell\t\t409.1\n"
    monkeypatch.setattr("sys.stdin", io.StringIO(lines))
    monkeypatch.setattr("sys.argv", ["ros_node.py", "/skin"])
    runpy.run_path(str(ROOT / "docs/examples/ros_node.py"), run_name="__main__")
    assert published[:3] == [
        ("/skin/touch", "column 3"),
        ("/skin/probability", 0.9712),
        ("/skin/touch", "cannot tell"),
    ]
    assert math.isnan(published[3][1]) and ended == ["rcskin"]
