"""The .deb: what installing, upgrading, removing and purging do to a system."""


def install(world):
    """Installed as on a vehicle, it enables and starts nothing by itself."""
    guest = world.guest
    guest.check("dpkg -i /share/waymark-locd.deb", timeout_s=180)
    assert guest.run("systemctl is-enabled locd")[1] == "disabled"
    assert guest.run("systemctl is-active locd")[1] == "inactive"
    guest.check("getent passwd locd && id -nG locd | grep -qw video")
    guest.check("test -f /etc/locd/locd.toml && test -d /var/lib/locd/recordings")
    assert guest.check("stat -c '%U %a' /var/lib/locd") == "locd 750"
    guest.check("systemd-analyze verify locd.service")


def exposure_to_attack(world):
    """systemd's own measure of the sandbox, also with the drop-in for real-time threads."""
    assert_security(world, 16)
    world.guest.check("cd /etc/systemd/system && mkdir -p locd.service.d && dpkg-deb --fsys-tarfile "
                      "/share/waymark-locd.deb | tar -xO ./usr/share/doc/waymark-locd/examples/realtime.conf "
                      ">locd.service.d/realtime.conf && systemctl daemon-reload")
    try:
        assert_security(world, 16)
    finally:
        world.guest.check("rm /etc/systemd/system/locd.service.d/realtime.conf && systemctl daemon-reload")


def assert_security(world, tenths):
    code, text = world.guest.run(f"systemd-analyze security --no-pager --threshold={tenths} locd.service", 60)
    assert code == 0, f"more exposed than {tenths / 10}:\n{text}"


def upgrade(world):
    """Another version takes over: configuration and quarantine stay, what ran runs again."""
    guest = world.guest
    world.localize()
    guest.check("echo '# ours' >>/etc/locd/locd.toml; install -o locd -m 640 /dev/null /var/lib/locd/kept")
    pid = world.locd.pid()
    guest.check("cd /root && rm -rf next && dpkg-deb -R /share/waymark-locd.deb next && "
                "sed -i 's/^Version: .*/&+1/' next/DEBIAN/control && dpkg-deb -b -Znone next next.deb", 120)
    guest.check("dpkg -i --force-confold /root/next.deb", 180)
    assert guest.check("dpkg-query -W -f '${Version}' waymark-locd").endswith("+1")
    guest.check("grep -q '# ours' /etc/locd/locd.toml && test -f /var/lib/locd/kept")
    world.locd.wait_until("ActiveState", "active")
    assert world.locd.pid() != pid, "the old program goes on"
    world.wait_for_full_pose()


def remove(world):
    """Removed, it stops and leaves configuration and state; purged, nothing of ours is left."""
    guest = world.guest
    guest.check("systemctl start locd", 120)
    guest.check("dpkg --remove waymark-locd", 120)
    assert guest.run("pgrep -x locd")[0] == 1, "it still runs"
    guest.check("test ! -e /usr/bin/locd && test -f /etc/locd/locd.toml && test -d /var/lib/locd")
    guest.check("umount /var/lib/locd/recordings 2>/dev/null; rm -f /etc/locd/*.map /etc/locd/*.yaml "
                "/etc/locd/markers.toml; dpkg --purge waymark-locd", 120)
    left = guest.run("find /etc /var /usr -xdev -name '*locd*' -not -path '/var/log/*' -not -path '/var/cache/*' "
                     "-not -path '*/locd.service.d*'")[1]
    assert left == "", f"purge leaves {left}"
    assert guest.run("dpkg-query -W -f '${Status}' waymark-locd")[1].find("installed") < 0
