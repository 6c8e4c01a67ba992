"""The virtual machine as a process: one QEMU with software emulation, which outlives the test that starts it.

Everything of a run lies in one folder, the run folder: sockets, the console's log, the disk of recordings,
the folder that is shared with the guest.
"""

import os
import pathlib
import signal
import subprocess

import processes

CAMERA_PORTS = 3
# Whatever happens to the tests, no machine runs longer than this. All of them have taken half an hour beside
# other work.
LIFETIME_S = 3 * 3600
# The disk of recordings: small enough to be filled, large enough for a recording of a minute.
RECORDINGS_MB = 160

KERNEL_ARGUMENTS = [
    "console=ttyS0", "quiet", "loglevel=4", "systemd.show_status=0", "mitigations=off", "nokaslr",
    "tsc=reliable", "no_timer_check", "audit=0", "apparmor=0", "cryptomgr.notests", "random.trust_cpu=on",
    "net.ifnames=0",
    # A kernel that fails ends the machine, and with it whoever waits for an answer.
    "oops=panic", "panic=-1",
]


class Machine:
    def __init__(self, run):
        self.run = pathlib.Path(run)
        self.pid_file = self.run / "qemu.pid"
        self.console = self.run / "console.log"
        self.share = self.run / "share"
        self.recordings = self.run / "recordings.ext4"

    def assemble(self, kernel, initrd, root):
        """Gives it a kernel and disks: a root of its own, an empty disk for recordings."""
        self.share.mkdir(parents=True, exist_ok=True)
        os.symlink(kernel, self.run / "kernel")
        os.symlink(initrd, self.run / "initrd")
        subprocess.run(["cp", "--sparse=always", root, self.run / "root.ext4"], check=True)
        subprocess.run(["mke2fs", "-q", "-t", "ext4", "-F", self.recordings, f"{RECORDINGS_MB}M"],
                       check=True)

    def start(self):
        """Gives it power and returns at once; sockets are named relative to the run folder, for their length is
        limited to 107 bytes."""
        # As initial RAM disks do after a power cut; this root has no journal.
        checked = subprocess.run(["e2fsck", "-y", self.run / "root.ext4"], check=False, capture_output=True, text=True)
        if checked.returncode not in (0, 1):
            raise OSError(f"the root's file system is damaged: {checked.stdout}{checked.stderr}")
        with open(self.console, "ab") as console:
            process = subprocess.Popen(
                ["timeout", "--kill-after=5", str(LIFETIME_S), *self._command()],
                cwd=self.run, stdin=subprocess.DEVNULL, stdout=console, stderr=console,
                start_new_session=True)
        self.pid_file.write_text(str(process.pid), encoding="utf-8")

    @staticmethod
    def _command():
        command = [
            "qemu-system-x86_64", "-machine", "q35", "-accel", "tcg,thread=multi,tb-size=512", "-cpu", "max",
            "-smp", "2", "-m", "2048", "-nodefaults", "-no-user-config", "-display", "none",
            "-serial", "stdio", "-no-reboot", "-nic", "none",
            "-kernel", "kernel", "-initrd", "initrd",
            "-append", " ".join(KERNEL_ARGUMENTS),
            # What has reached a disk outlasts the machine: the root for its next start, recordings to be looked
            # at from outside.
            "-drive", "if=none,id=root,file=root.ext4,format=raw,cache=unsafe",
            "-device", "virtio-blk-pci,drive=root",
            "-drive", "if=none,id=recordings,file=recordings.ext4,format=raw,cache=writeback",
            "-device", "virtio-blk-pci,drive=recordings",
            "-virtfs", "local,path=share,mount_tag=share,security_model=none,multidevs=remap",
            "-device", "virtio-rng-pci",
            "-device", "virtio-serial-pci",
            "-chardev", "socket,id=agent,path=agent.sock,server=on,wait=off",
            "-device", "virtserialport,chardev=agent,name=waymark.agent",
            "-device", "qemu-xhci,id=usb",
        ]
        for i in range(CAMERA_PORTS):
            command += ["-chardev", f"socket,id=camera{i},path=camera{i}.sock,reconnect=1",
                        "-device", f"usb-redir,chardev=camera{i},bus=usb.0,port={i + 1}"]
        return command

    def is_running(self):
        group = self._group()
        return group is not None and bool(processes.living(group, self.run))

    def _group(self):
        """The process group that was started; None: none was."""
        try:
            return int(self.pid_file.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None

    def kill(self):
        """As if the power were cut: what the guest has not written to its disks is lost. Nobody writes to them
        when this returns."""
        group = self._group()
        if group is not None:
            processes.end(group, self.run, signal.SIGKILL)
            self.pid_file.unlink()

    def has_panicked(self):
        """Whether the console's log ends with a kernel's panic, whose last line tells the kernel's offset."""
        return "Kernel Offset: " in self.last_words()

    def last_words(self):
        """The end of the console's log, for a message."""
        if not self.console.exists():
            return "(no console log)"
        return "\n".join(self.console.read_text(encoding="utf-8", errors="replace").splitlines()[-20:])
