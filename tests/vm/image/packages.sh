# The guest's root file system of Debian's packages, untouched: $OUT/root.ext4. The same suite as on the
# host, from where the host has it; other vendors' sources are left out.
sources=$(apt-get indextargets \
  --format 'deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $(REPO_URI) $(RELEASE) $(COMPONENT)' \
  'Created-By: Packages' 'Origin: Debian')
[ -n "$sources" ] || { echo "no apt source of Debian is configured, or apt-get update never ran"; exit 1; }
suite=$(. /etc/os-release && echo "$VERSION_CODENAME")

mmdebstrap --variant=minbase --mode=root --skip=check/empty --format=directory \
  --aptopt='APT::Install-Recommends "false"' --dpkgopt=force-unsafe-io \
  --dpkgopt='path-exclude=/usr/share/doc/*' --dpkgopt='path-exclude=/usr/share/man/*' \
  --dpkgopt='path-exclude=/usr/share/locale/*' \
  --include="$(echo $GUEST_PACKAGES | tr ' ' ,)" "$suite" "$OUT/tree" - <<<"$sources"

# No journal: what a run writes is thrown away with it.
truncate -s 2G "$OUT/root.ext4"
mke2fs -q -t ext4 -O ^has_journal,^metadata_csum -m 0 -E lazy_itable_init=1,root_owner=0:0 -d "$OUT/tree" "$OUT/root.ext4"
rm -rf "$OUT/tree"
