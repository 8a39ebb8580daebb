"""No aligned load or store of 32 or 64 bytes in the objects where tables of hardening are compiled.

    unaligned_moves.py OBJDUMP OBJECTS...

g++ 12.2 reads such tables, 8-byte aligned, with aligned moves in the epilogues of loops that it vectorizes
with 512 bits, and the program crashes, or not, by where the table happens to lie. The assembler is told
(-Wa,-muse-unaligned-vector-move) to make all of them unaligned, which costs nothing on aligned data. A
source that includes the tables but is not on the list in fem_solver/CMakeLists.txt would have them again.
"""
import re
import subprocess
import sys

# a register of 32 or 64 bytes and memory, in either order: vmovapd (%rax),%ymm1
ALIGNED = re.compile(r"\tvmov(apd|aps|dqa|dqa32|dqa64)\s+(?=.*%[yz]mm)(?=.*\()")
MEANT = re.compile(r"(_step|/model)\.cpp\.o$")    # kernels with materials in them, and who copies materials


def aligned_moves(objdump, path):
    text = subprocess.run([objdump, "-d", "--no-show-raw-insn", path], check=True, text=True,
                          stdout=subprocess.PIPE).stdout
    return [line.strip() for line in text.splitlines() if ALIGNED.search(line)], text.count("\tvmov")


def main():
    objdump, *objects = sys.argv[1:]
    objects = [path for path in objects if MEANT.search(path)]
    failed = len(objects) < 5
    if failed:
        print(f"only {len(objects)} objects with materials among those given")
    for path in objects:
        found, moves = aligned_moves(objdump, path)
        print(f"{path}: {moves} vector moves, {len(found)} aligned ones to or from memory")
        for line in found[:5]:
            print("   ", line)
        failed |= bool(found)
    sys.exit(failed)


main()
