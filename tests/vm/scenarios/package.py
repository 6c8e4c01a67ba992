"""The .deb: what installing, upgrading, removing and purging do to a system."""

import re
import shutil
import subprocess

from disks import MOUNT, localize_with_disk


def install(world):
    """Installed as on a vehicle, it enables and starts nothing by itself."""
    guest = world.guest
    guest.check("dpkg -i /share/waymark-locd.deb", timeout_s=180)
    assert guest.run("systemctl is-enabled locd")[1] == "disabled"
    assert guest.run("systemctl is-active locd")[1] == "inactive"
    guest.check("getent passwd locd && id -nG locd | grep -qw video")
    guest.check("test -f /etc/locd/locd.toml && test -d /var/lib/locd/recordings")
    assert guest.check("stat -c '%U %a' /var/lib/locd") == "locd 750"
    guest.check("systemd-analyze verify locd.service && test $(sysctl -n net.core.rmem_max) -eq 2097152")


def upgrade(world):
    """Another version takes over: configuration and quarantine stay, what ran runs again."""
    guest = world.guest
    guest.check("dpkg --purge waymark-libcamera")  # it wants locd of its own version
    world.localize()
    guest.check("systemctl enable --quiet locd; echo '# ours' >>/etc/locd/locd.toml; install -o locd -m 640 /dev/null /var/lib/locd/kept")
    pid = world.locd.pid()
    make_next(world.share / "waymark-locd.deb", world.run / "next", world.share / "next.deb")
    guest.check("dpkg -i --force-confold /share/next.deb", 180)
    assert guest.check("dpkg-query -W -f '${Version}' waymark-locd").endswith("+1")
    guest.check("grep -q '# ours' /etc/locd/locd.toml && test -f /var/lib/locd/kept && systemctl is-enabled locd")
    world.wait_until("locd runs again", lambda: world.locd.show("ActiveState") == "active")
    assert world.locd.pid() != pid, "the old program goes on"
    world.wait_for_full_pose()


def make_next(package_file, folder, next_file):
    """The same package under a higher version."""
    shutil.rmtree(folder, ignore_errors=True)
    subprocess.run(["dpkg-deb", "-R", package_file, folder], check=True)
    control = folder / "DEBIAN/control"
    control.write_text(re.sub(r"^Version: .*", r"\g<0>+1", control.read_text(encoding="utf-8"), flags=re.M),
                       encoding="utf-8")
    subprocess.run(["dpkg-deb", "-b", "-Znone", folder, next_file], check=True, stdout=subprocess.DEVNULL)


def remove(world):
    """Removed, it stops and leaves all else; purged, maps, rig files and a mounted disk of recordings stay."""
    guest = world.guest
    localize_with_disk(world)
    guest.check(f"systemctl enable --quiet locd; echo kept >{MOUNT}/of-another-disk")
    # The driver's package wants locd's of its own version: both go.
    guest.check("dpkg --purge waymark-libcamera; dpkg --remove waymark-locd", 120)
    assert guest.run("pgrep -x locd")[0] == 1, "it still runs"
    guest.check("test ! -e /usr/bin/locd && test -f /etc/locd/locd.toml && test -d /var/lib/locd")
    purged = guest.check("dpkg --purge waymark-locd", 120)
    assert f"/var/lib/locd stays, for something is mounted in it: {MOUNT}" in purged, purged
    guest.check(f"test -s {MOUNT}/of-another-disk -a -s /etc/locd/room.map -a -s /etc/locd/rig.yaml")
    left = guest.run("find /etc /var /usr -xdev -name '*locd*' -not -path '/var/log/*' -not -path '/var/cache/*' "
                     "-not -path '*/locd.service.d*'")[1].split()
    # The folder stays as it is, with the file by which one locd keeps others out.
    assert sorted(left) == ["/etc/locd", "/var/lib/locd", "/var/lib/locd/locd.lock"], f"purge leaves {left}"
    guest.check(f"umount {MOUNT} && rm -r /etc/locd /var/lib/locd")
    assert guest.run("dpkg-query -W -f '${Status}' waymark-locd")[1].find("installed") < 0
