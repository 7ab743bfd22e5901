// Begins a program on QEMU's `sim` with Xtensa, and asks QEMU to read and write ("simcall").
// RAM is zero at the beginning. A fault ends the emulator with status 1.
//
// The LX6 has a window on 64 registers that moves with each call: what leaves it is saved by the
// handlers at the beginning, whose places the chip fixes. The lx106 has 16 registers and no window.

// The assembler of LLVM has no name for it. The call is in a2, its arguments in a3 to a5, and its
// result in a2.
    .macro ask_qemu
    .byte 0x00, 0x51, 0x00
    .endm

    .macro end_at_fault
    movi a2, 1
    movi a3, 1
    ask_qemu
    .endm

    .section .text.first, "ax"
    .balign 16
vectors:
#ifndef __XTENSA_CALL0_ABI__
    .org 0x00  // a call needs 4 registers that are taken
    s32e a0, a5, -16
    s32e a1, a5, -12
    s32e a2, a5, -8
    s32e a3, a5, -4
    rfwo
    .org 0x40  // a return to 4 that were saved
underflow4:
    l32e a0, a5, -16
    l32e a1, a5, -12
    l32e a2, a5, -8
    l32e a3, a5, -4
    rfwu
    .org 0x80  // 8 registers
    s32e a0, a9, -16
    l32e a0, a1, -12
    s32e a1, a9, -12
    s32e a2, a9, -8
    s32e a3, a9, -4
    s32e a4, a0, -32
    s32e a5, a0, -28
    s32e a6, a0, -24
    s32e a7, a0, -20
    rfwo
    .org 0xc0
underflow8:
    l32e a0, a9, -16
    l32e a1, a9, -12
    l32e a2, a9, -8
    l32e a7, a1, -12
    l32e a3, a9, -4
    l32e a4, a7, -32
    l32e a5, a7, -28
    l32e a6, a7, -24
    l32e a7, a7, -20
    rfwu
    .org 0x100  // 12 registers
    s32e a0, a13, -16
    l32e a0, a1, -12
    s32e a1, a13, -12
    s32e a2, a13, -8
    s32e a3, a13, -4
    s32e a4, a0, -48
    s32e a5, a0, -44
    s32e a6, a0, -40
    s32e a7, a0, -36
    s32e a8, a0, -32
    s32e a9, a0, -28
    s32e a10, a0, -24
    s32e a11, a0, -20
    rfwo
    .org 0x140
underflow12:
    l32e a0, a13, -16
    l32e a1, a13, -12
    l32e a2, a13, -8
    l32e a11, a1, -12
    l32e a3, a13, -4
    l32e a4, a11, -48
    l32e a5, a11, -44
    l32e a6, a11, -40
    l32e a7, a11, -36
    l32e a8, a11, -32
    l32e a9, a11, -28
    l32e a10, a11, -24
    l32e a11, a11, -20
    rfwu
    .org 0x300  // a fault in the kernel
    end_at_fault
    .org 0x340  // a fault in the program, or the stack moves while the caller's registers are on it
    wsr a0, excsave1
    rsr a0, exccause
    beqi a0, 5, move_stack
    end_at_fault
    .org 0x3c0  // a fault in a handler
    end_at_fault

// Loads the caller's registers as a return to it would; the stack is moved again after that.
move_stack:
    rsr a0, windowbase
    rotw -1  // what was in a0 is in a4, and a0 to a3 are free
    rsr a2, ps
    extui a3, a2, 8, 4  // the window that a return leads back to: that of now
    xor a3, a3, a4
    rsr a4, excsave1
    slli a3, a3, 8
    xor a2, a2, a3
    wsr a2, ps
    rsync
    bbsi a4, 31, 1f
    j underflow4
1:  rotw -1
    bbsi a8, 30, 2f
    j underflow8
2:  rotw -1
    j underflow12
#else
    .org 0x30  // faults: in the kernel, in the program, in a handler
    end_at_fault
    .org 0x50
    end_at_fault
    .org 0x70
    end_at_fault
#endif

    .section .text.start, "ax"
    .balign 4
    .literal_position
    .literal .Lstack, stack_top
    .literal .Lvectors, vectors
    .literal .Lserve, serve
    .literal .Lstate, 0x40020  // the window moves; faults of the program
    .global _start
_start:
    l32r a4, .Lvectors
    wsr a4, vecbase
#ifndef __XTENSA_CALL0_ABI__
    movi a4, 0
    wsr a4, windowbase
    rsync
    movi a4, 1
    wsr a4, windowstart
    rsync
    l32r a4, .Lstate
    wsr a4, ps
    rsync
    l32r a1, .Lstack
    movi a0, 0
    l32r a8, .Lserve
    callx8 a8
#else
    l32r a1, .Lstack
    l32r a8, .Lserve
    callx0 a8
#endif
    movi a2, 1  // the program ended by itself
    movi a3, 0
    ask_qemu

#ifndef __XTENSA_CALL0_ABI__
    .macro begin_call
    entry a1, 32
    .endm
    .macro end_call
    retw
    .endm
#else
    .macro begin_call
    .endm
    .macro end_call
    ret
    .endm
#endif

// Both: the call, the pipe, where, how much.
    .balign 4
    .global host_read
host_read:
    begin_call
    mov a5, a3
    mov a4, a2
    movi a3, 0
    movi a2, 3
    ask_qemu
    end_call

    .balign 4
    .global host_write
host_write:
    begin_call
    mov a5, a3
    mov a4, a2
    movi a3, 1
    movi a2, 4
    ask_qemu
    end_call
