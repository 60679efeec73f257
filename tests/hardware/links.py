"""Links to a virtual meter: its TCP port, and a serial line that ends there."""

import os
import select
import socket
from contextlib import contextmanager, suppress
from threading import Thread


@contextmanager
def over_tcp(ports):
    """Resource of the port itself."""
    yield ports.resource


@contextmanager
def over_a_serial_line(ports):
    """Resource of a terminal whose other end is the port. A port that hangs up is called again."""
    import tty

    ours, theirs = os.openpty()
    tty.setraw(theirs)
    stop, stopped = os.pipe()

    def carry():
        while True:
            with suppress(OSError), socket.create_connection((ports.host, ports.meter)) as line:
                while True:
                    ready, _, _ = select.select([ours, line, stop], [], [])
                    if stop in ready:
                        return
                    if ours in ready:
                        line.sendall(os.read(ours, 4096))
                    if line in ready:
                        received = line.recv(4096)
                        if not received:
                            break
                        os.write(ours, received)

    thread = Thread(target=carry, daemon=True)
    thread.start()
    try:
        yield f"ASRL{os.ttyname(theirs)}::INSTR"
    finally:
        os.write(stopped, b"x")
        thread.join(5)
        for each in (ours, theirs, stop, stopped):
            os.close(each)


LINKS = {"tcp": over_tcp, "serial": over_a_serial_line}
