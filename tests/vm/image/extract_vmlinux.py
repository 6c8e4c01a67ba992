#!/usr/bin/env python3
"""Takes the kernel proper out of a compressed x86 kernel image. Usage: extract_vmlinux.py VMLINUZ VMLINUX

The image's header says where the payload lies (Linux, Documentation/x86/boot.rst: setup_sects,
payload_offset, payload_length); Debian packs it with xz.
"""

import lzma
import pathlib
import struct
import sys

image = pathlib.Path(sys.argv[1]).read_bytes()
(setup_sectors,) = struct.unpack_from("<B", image, 0x1F1)
payload_offset, payload_length = struct.unpack_from("<II", image, 0x248)
begin = (setup_sectors + 1) * 512 + payload_offset
# The packer appends the unpacked size (4 bytes) to the stream.
payload = image[begin:begin + payload_length]
kernel = lzma.LZMADecompressor().decompress(payload)
if kernel[:4] != b"\x7fELF":
    sys.exit(f"{sys.argv[1]}: no kernel in there")
pathlib.Path(sys.argv[2]).write_bytes(kernel)
