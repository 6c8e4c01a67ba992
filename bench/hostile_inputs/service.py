"""locd while it runs: hostile reloads, requests and signals. Watched as systemd watches it, by its notify socket."""

import os
import pathlib
import resource
import select
import shutil
import signal
import socket
import subprocess
import time

import by_hand
import stand as good

STARVED_S = 5.0  # WatchdogSec of the unit, and systemd's patience for an answer
TERM_S = 5.0
MEBI = 1 << 20
FIELDS = {"READY", "STATUS", "RELOADING", "MONOTONIC_USEC", "WATCHDOG", "STOPPING", "ERRNO", "EXTEND_TIMEOUT_USEC"}


class Wrong(Exception):
    """What ought not to have happened, in words."""


class Service:
    def __init__(self, stand, descriptors=None):
        self.folder = stand.folder / "service"
        shutil.rmtree(self.folder / "state", ignore_errors=True)
        for name in ("", "state", "run"):
            (self.folder / name).mkdir(exist_ok=True)
        for name in ("locd.toml", "rig.yaml", "markers.toml"):
            (self.folder / name).write_bytes(stand.text(name))
        (self.folder / "good.map").write_bytes((stand.folder / "good.map").read_bytes())
        if not (self.folder / "images").exists():
            (self.folder / "images").symlink_to(stand.folder / "images")
        self.notify = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        address = str(self.folder / "notify")
        pathlib.Path(address).unlink(missing_ok=True)
        self.notify.bind(address)
        self.errors = open(self.folder / "stderr", "w+b")
        environment = {**os.environ, "NOTIFY_SOCKET": address, "STATE_DIRECTORY": str(self.folder / "state"),
                       "RUNTIME_DIRECTORY": str(self.folder / "run"), "WATCHDOG_USEC": str(int(STARVED_S * 1e6))}

        def limit():
            if descriptors:
                resource.setrlimit(resource.RLIMIT_NOFILE, (descriptors, descriptors))
        self.process = subprocess.Popen([stand.locd, "--config", str(self.folder / "locd.toml")], env=environment,
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=self.errors,
                                        preexec_fn=limit)
        self.gap_s = 0.0
        self.fed = time.monotonic()

    def watch(self, until=lambda fields: False, seconds=20.0):
        """Takes what it tells, until that is told; False after so long, with nothing left to take."""
        end = time.monotonic() + seconds
        while True:
            left = end - time.monotonic()
            if not select.select([self.notify], [], [], max(0.0, min(left, 0.1)))[0]:
                if left <= 0 or self.process.poll() is not None:
                    return False
                continue
            data = self.notify.recv(1 << 20)
            if len(data) > 4096:
                raise Wrong(f"a datagram of {len(data)} bytes")
            fields = dict(line.split("=", 1) for line in data.decode().strip("\n").split("\n"))
            if set(fields) - FIELDS or fields.get("WATCHDOG", "1") != "1":
                raise Wrong(f"told: {data!r}")
            if "WATCHDOG" in fields:
                self.gap_s = max(self.gap_s, time.monotonic() - self.fed)
                self.fed = time.monotonic()
            if until(fields):
                return True
        return False

    def ready(self):
        if not self.watch(lambda fields: "READY" in fields, 30):
            raise Wrong("did not become ready")
        self.fed = time.monotonic()
        self.gap_s = 0.0

    def reload(self):
        self.process.send_signal(signal.SIGHUP)
        if not self.watch(lambda fields: "READY" in fields, 30):
            raise Wrong("the reload did not end")

    def connect(self):
        client = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        client.settimeout(STARVED_S)
        client.connect(str(self.folder / "run" / "control"))
        return client

    def ask(self, text=b"status\n"):
        with self.connect() as client:
            client.sendall(text)
            return client.recv(4096)

    def high_water_kb(self):
        for line in pathlib.Path(f"/proc/{self.process.pid}/status").read_text(encoding="ascii").splitlines():
            if line.startswith("VmHWM"):
                return int(line.split()[1])
        return 0

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def end(self):
        """Still there, fed its watchdog, answers, and ends when told."""
        kilobytes = 0
        if self.process.poll() is None:
            self.watch(seconds=0.5)
            kilobytes = self.high_water_kb()
            if not self.ask().startswith(b"ok"):
                raise Wrong("no answer to a request")
            self.process.send_signal(signal.SIGTERM)
            try:
                self.process.wait(TERM_S)
            except subprocess.TimeoutExpired as late:
                raise Wrong("SIGTERM did not end it") from late
        if self.gap_s > STARVED_S:
            raise Wrong(f"watchdog not fed for {self.gap_s:.1f} s")
        return good.Run(self.process.returncode, 0.0, kilobytes, b"")

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self.errors.close()
        self.notify.close()


def run(stand, deed, descriptors=None):
    service = Service(stand, descriptors)
    try:
        service.ready()
        deed(service)
        return service.end()
    except (Wrong, OSError) as wrong:
        code = service.process.poll()
        died = code is not None and code < 0
        service.errors.seek(0)
        text = f"{wrong} (watchdog gap {service.gap_s:.1f} s) ".encode() + service.errors.read(500)
        return good.Run(code if died else 1, 0.0, 0, text)
    finally:
        service.close()


def all_of(stand, deeds):
    if "service" not in stand.baselines:
        stand.baselines["service"] = run(stand, lambda service: service.reload())
    for name, deed, *descriptors in deeds:
        yield name, "taken", None, run(stand, deed, *descriptors)


def reloads(stand):
    """The file is refused whole, or taken; all goes on."""
    def with_file(file, *pieces):
        def deed(service):
            by_hand.fill(service.folder / file, *pieces)
            service.reload()
            (service.folder / file).unlink(missing_ok=True)
        return deed
    rig = good.RIG.encode()
    half = (stand.folder / "good.map").read_bytes()
    inject = b'  "T_x\\nWATCHDOG=trigger\\n<0>": 1\n'
    return all_of(stand, [
        ("locd.toml: a key of 131,500 bytes", with_file("locd.toml", (b"k", 131_500), (b" = 1\n", 1))),
        ("locd.toml: 60,000 dots", with_file("locd.toml", (b"a.", 60_000), (b"a = 1\n", 1))),
        ("locd.toml: line ends in a key", with_file("locd.toml", (b'"a\\nWATCHDOG=trigger\\nb" = 1\n', 1))),
        ("locd.toml: 1 MB of [", with_file("locd.toml", (b"[", MEBI - 1))),
        ("rig.yaml: a key of 140,000 bytes", with_file("rig.yaml", (rig + b"  ", 1), (b"k", 140_000), (b": 1\n", 1))),
        ("rig.yaml: line ends in a key", with_file("rig.yaml", (rig + inject, 1))),
        ("rig.yaml: 60,000 keys", with_file("rig.yaml", (rig, 1), *[(f"  k{i}: 1\n".encode(), 1) for i in range(60_000)])),
        ("rig.yaml: 100000 px", with_file("rig.yaml", (rig.replace(b"[64, 48]", b"[100000, 100000]"), 1))),
        ("map: half", with_file("good.map", (half[:len(half) // 2], 1))),
        ("map: 257 MB", with_file("good.map", (half, 1), (b"\0", 257 * MEBI))),
        ("quarantine.json: 16 MB of [", with_file("state/quarantine.json", (b"[", 16 * MEBI))),
    ])


def requests(stand):
    def says(text, shutdown=False):
        def deed(service):
            with service.connect() as client:
                try:
                    client.sendall(text)
                    if shutdown:
                        client.shutdown(socket.SHUT_WR)
                    client.settimeout(0.5)
                    client.recv(1 << 16)
                except (BrokenPipeError, ConnectionResetError, TimeoutError):
                    pass  # it may hang up on us
            service.watch(seconds=0.3)
        return deed

    def crowd(service):
        clients = []
        for _ in range(200):
            try:
                clients.append(service.connect())
            except BlockingIOError:
                service.watch(seconds=0.02)  # as many wait as may
        service.watch(seconds=1)
        for client in clients:
            client.close()

    def flood(service):
        end = time.monotonic() + 3
        while time.monotonic() < end:
            service.ask(b"no such request\n")
            service.watch(seconds=0.0)
        service.watch(seconds=0.5)

    def slow_reader(service):
        with service.connect() as client:
            client.settimeout(0.2)
            try:
                for _ in range(4000):
                    client.sendall(b"status\n" * 30)
            except (BrokenPipeError, ConnectionResetError, TimeoutError):
                pass
            service.watch(seconds=1)

    def no_descriptors(service):
        room = service.descriptors()
        before_it = resource.prlimit(service.process.pid, resource.RLIMIT_NOFILE)
        resource.prlimit(service.process.pid, resource.RLIMIT_NOFILE, (room, before_it[1]))
        clients = [service.connect() for _ in range(5)]
        before = processor_s(service)
        service.watch(seconds=3)
        spent = processor_s(service) - before
        for client in clients:
            client.close()
        resource.prlimit(service.process.pid, resource.RLIMIT_NOFILE, before_it)
        if time.monotonic() - service.fed > STARVED_S:
            raise Wrong("no watchdog without descriptors")
        if spent > 1.5:
            raise Wrong(f"{spent:.1f} s of processor time in 3 s without descriptors")

    def recording(service):
        for request in (b"start\n", b"status\n", b"start\n", b"stop\n", b"stop\n") * 3:
            service.ask(request)
            service.watch(seconds=0.05)
    return all_of(stand, [
        ("half a line", says(b"stat")), ("NUL", says(b"\0" * 100 + b"\n")), ("CRLF", says(b"status\r\n")),
        ("100 kB in a line", says(b"x" * 100_000)), ("half-closed", says(b"status\n", True)),
        ("nothing, half-closed", says(b"", True)), ("512 lines", says(b"status\n" * 512)),
        ("escape sequences", says(b"\x1b[2J\xff\xfe\n")), ("200 clients", crowd), ("flood of 3 s", flood),
        ("slow reader", slow_reader), ("start and stop, 15 times", recording), ("no descriptors left", no_descriptors)])


def processor_s(service):
    ticks = pathlib.Path(f"/proc/{service.process.pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
    return (int(ticks[11]) + int(ticks[12])) / os.sysconf("SC_CLK_TCK")


def signals(stand):
    def storm(service):
        """Reloads as fast as they can be asked for."""
        end = time.monotonic() + 6
        while time.monotonic() < end:
            for _ in range(20):
                service.process.send_signal(signal.SIGHUP)
                time.sleep(0.0005)
            service.watch(seconds=0.0)
        service.ask()
        service.watch(seconds=2)

    def stopped(service):
        service.process.send_signal(signal.SIGSTOP)
        time.sleep(3)
        service.process.send_signal(signal.SIGCONT)
        service.ask()
        service.fed = time.monotonic()

    def pipe(service):
        service.process.send_signal(signal.SIGPIPE)
        service.watch(seconds=0.3)

    def both(service):
        for _ in range(20):
            service.process.send_signal(signal.SIGHUP)
        service.process.send_signal(signal.SIGTERM)
        service.process.wait(TERM_S)
    yield from all_of(stand, [("SIGHUP storm, 6 s", storm), ("SIGSTOP, 3 s", stopped), ("SIGPIPE", pipe),
                              ("SIGHUP and SIGTERM at once", both)])
    for milliseconds in (0, 5, 20, 50, 100, 200, 500):
        service = Service(stand)
        time.sleep(milliseconds / 1000)
        service.process.send_signal(signal.SIGTERM)
        try:
            code = service.process.wait(TERM_S)
        except subprocess.TimeoutExpired:
            code = None
        service.close()
        # Before locd has taken over the signal, the system ends it.
        yield f"SIGTERM after {milliseconds} ms", "taken", None, good.Run(0 if code == -signal.SIGTERM else code, 0.0, 0, b"")


GROUPS = [("reloads of a running locd with hostile files", reloads),
          ("control socket: partial, NUL, long, flood, slow reader, no descriptors", requests),
          ("signals: SIGHUP storm, SIGSTOP, SIGPIPE, SIGTERM at seven moments of the start", signals)]
