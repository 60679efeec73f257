"""Runs commands of rcskin where no network can be reached, and notes which tried to reach one.

`python offline.py NOTES < LINES`: each line is a command without the word rcskin. One that ends in
`&` goes on while the others run; `{resource}` and `{control}` stand for what it prints. NOTES gets
a line of JSON for each attempt, and one for each command that ended. An audit hook sees the calls
of Python. `--alone` says that the process has a network namespace of its own: there, counters of
the kernel also see the calls of native code.
"""

import contextlib
import io
import json
import re
import shlex
import socket
import struct
import subprocess
import sys
import traceback
from pathlib import Path

OF_SOCKETS = {f"socket.{name}" for name in ("connect", "sendto", "sendmsg", "bind")}
OF_HOSTS = {f"socket.{name}" for name in ("getaddrinfo", "gethostbyname", "gethostbyaddr")}
LOOPBACK = re.compile(r"127\.[\d.]+|::1|localhost")
COUNTERS = ("Ip OutNoRoutes", "Udp OutDatagrams", "Ip6OutNoRoutes", "Udp6OutDatagrams")
"""Packets that had no way out, and datagrams: names of hosts are asked for by those."""
SIOCSIFFLAGS, IFF_UP = 0x8914, 1


def refuse_network(note):
    """From now on, an attempt to reach another computer, or to listen to one, is noted and fails.

    Nothing takes such a hook away again: it needs a process of its own.
    """

    def hook(event, given):
        if event in OF_SOCKETS and given[0].family in (socket.AF_INET, socket.AF_INET6):
            host = given[1][0] if given[1] else "127.0.0.1"
        elif event in OF_HOSTS and given[0] is not None:
            host = given[0].decode() if isinstance(given[0], bytes) else given[0]
        else:
            return
        if not LOOPBACK.fullmatch(host):
            note(tried=f"{event} {host!r}", calls="".join(traceback.format_stack(limit=8)))
            raise OSError(f"there is no network: {event} {host!r}")

    sys.addaudithook(hook)


def start_loopback():
    """In a new network namespace it is off; it stays the only interface."""
    import fcntl

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        fcntl.ioctl(any_socket, SIOCSIFFLAGS, struct.pack("16sh14x", b"lo", IFF_UP))


def counted():
    """The kernel's counters of this network namespace that rise if something looks outside."""
    lines = Path("/proc/net/snmp").read_text().splitlines()
    found = dict(line.split() for line in Path("/proc/net/snmp6").read_text().splitlines())
    for names, values in zip(lines[::2], lines[1::2], strict=True):
        of, *names = names.split()
        found |= {
            f"{of[:-1]} {name}": value
            for name, value in zip(names, values.split()[1:], strict=True)
        }
    return {name: int(found.get(name, 0)) for name in COUNTERS}


def run(words):
    """Runs a command in this process; gives its exit code."""
    from rcskin.__main__ import main

    sys.argv = ["rcskin", *words]
    try:
        main()
    except SystemExit as end:
        return end.code or 0


def in_background(line, notes):
    """A process with a command that serves, and what it prints when it is ready."""
    command = [sys.executable, __file__, notes, "--serve"]
    served = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    served.stdin.write(line)
    served.stdin.close()
    resource, _, control = served.stdout.readline().split()
    return served, {"{resource}": resource, "{control}": control}


def main(notes, *flags):
    def note(**content):
        with Path(notes).open("a") as file:
            file.write(json.dumps({"line": line, **content}) + "\n")

    serving, known = [], {}
    if "--alone" in flags:
        start_loopback()
    refuse_network(note)
    for line in sys.stdin.read().splitlines():
        for name, value in known.items():
            line = line.replace(name, value)
        if line.endswith("&"):
            served, known = in_background(line[:-1], notes)
            serving.append(served)
        elif "--serve" in flags:
            run(shlex.split(line))
        else:
            shown = io.StringIO()
            with contextlib.redirect_stdout(shown), contextlib.redirect_stderr(shown):
                code = run(shlex.split(line))
            note(code=code, shown=shown.getvalue(), counted=counted() if "--alone" in flags else {})
    for served in serving:
        served.terminate()
        served.wait(20)


if __name__ == "__main__":
    main(*sys.argv[1:])
