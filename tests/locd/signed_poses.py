#!/usr/bin/env python3
"""Poses that locd signs: the example believes them, none without the key, and none a second time.

To be run in a network namespace of its own. Usage: signed_poses.py LOCD VERIFIED_POSES
"""

import pathlib
import socket
import subprocess
import sys
import tempfile

import hundred_sets

GROUP, PORT = "239.255.76.67", 7667
URL = f"udpm://{GROUP}:{PORT}?ttl=0"
CHANNEL = b"WAYMARK_SIGNED_POSE\0"
# LCM's packet: a magic word, the packet's number, the channel's name.
CHANNEL_BEGIN = 8
PATIENCE_S = 60
# What the example says of poses that took more than a second: of a machine that stands still now and then.
OLD = "not believed: not of now"


class Eavesdropper:
    """Hears packets of the group, and sends them again."""

    def __init__(self):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        self.socket.settimeout(PATIENCE_S)
        self.socket.bind((GROUP, PORT))
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                               socket.inet_aton(GROUP) + socket.inet_aton("127.0.0.1"))

    def signed_pose(self):
        while True:
            packet = self.socket.recv(65536)
            if packet[CHANNEL_BEGIN:].startswith(CHANNEL):
                return packet

    def send(self, packet):
        self.socket.sendto(packet, (GROUP, PORT))


def listen(program, key, count):
    listener = subprocess.Popen([program, key, str(count), URL], stdout=subprocess.PIPE, text=True)
    assert listener.stdout.readline() == "listening\n"
    return listener


def lines_of(listener):
    output = listener.communicate(timeout=PATIENCE_S)[0]
    assert listener.returncode == 0, output
    return output.splitlines()


def believed(lines):
    return [line for line in lines if line.startswith("pose ")]


def write_key(file, digits):
    file.touch(mode=0o600)
    file.write_text(digits + "\n", encoding="utf-8")
    return file


def main():
    program = sys.argv[2]
    with tempfile.TemporaryDirectory() as work:
        folder = pathlib.Path(work)
        hundred_sets.write_inputs(folder, URL, 'key_file = "pose.key"')
        key = write_key(folder / "pose.key", "0123456789abcdef" * 4)
        another = write_key(folder / "another.key", "0123456789abcde0" * 4)
        with open(folder / "log", "wb") as log, hundred_sets.start(sys.argv[1], folder, log) as locd:
            try:
                genuine = lines_of(listen(program, key, 20))
                assert believed(genuine) and len(believed(genuine)) + genuine.count(OLD) == 20, genuine
                forged = lines_of(listen(program, another, 5))
                assert forged == ["not believed: forged"] * 5, forged
                # Played again, at once; with one bit changed; with its number raised.
                eavesdropper = Eavesdropper()
                listener = listen(program, key, 60)
                packet = eavesdropper.signed_pose()
                # Only who has heard a pose knows an older one.
                first = [listener.stdout.readline().rstrip("\n")]
                while not first[-1].startswith("pose "):
                    first.append(listener.stdout.readline().rstrip("\n"))
                changed = packet[:-20] + bytes([packet[-20] ^ 1]) + packet[-19:]
                seq_end = CHANNEL_BEGIN + len(CHANNEL) + 8 + 8  # after the type's hash
                renumbered = packet[:seq_end - 2] + b"\x7f" + packet[seq_end - 1:]
                for attack in (packet, changed, renumbered):
                    eavesdropper.send(attack)
                said = [*first, *lines_of(listener)]
                again = said.count("not believed: played again")
                assert said.count("not believed: forged") == 2, said
                # On a machine that stood still meanwhile it is too old besides.
                assert again == 1 or (again == 0 and OLD in said), said
                assert len(believed(said)) + said.count(OLD) == 58 - again, said
            finally:
                locd.terminate()
        assert locd.returncode == 0, (folder / "log").read_text(encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
