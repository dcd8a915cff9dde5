#!/bin/sh
# Install, on Debian, what tests/check_cross.sh and tools/firmware need: compilers for other processors and QEMU. As root or
# through a sudo that asks nothing. Some 1.5 GB. SPDX-License-Identifier: MIT
set -eu

packages="qemu-user qemu-system-arm qemu-system-misc
    gcc-arm-none-eabi libnewlib-arm-none-eabi gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf"
for target in aarch64:arm64 riscv64:riscv64 powerpc64le:ppc64el s390x:s390x i686:i386; do
    packages="$packages gcc-${target%:*}-linux-gnu libc6-dev-${target#*:}-cross"
done
packages="$packages gcc-arm-linux-gnueabihf libc6-dev-armhf-cross"

command -v apt-get > /dev/null 2>&1 || {
    echo "cross.sh: not a Debian; wanted are:" $packages >&2
    exit 1
}
as_root=
[ "$(id -u)" = 0 ] || as_root='sudo -n'
$as_root env DEBIAN_FRONTEND=noninteractive apt-get update -qq || echo "apt-get update reported an error; going on" >&2
# shellcheck disable=SC2086
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $packages > /dev/null
echo "cross.sh: installed"
