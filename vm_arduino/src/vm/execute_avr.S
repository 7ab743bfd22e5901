; Machine::execute for the AVR: the inner loop of the machine.
;
; Means the same as `execute` in `inner_loop.cpp`, which is for all other chips. A byte of code
; is the place of a jump in a table, and where it leads is what an instruction does. What asks
; something of the robot or of the clock is `Machine::act`, in C++, for every chip.
;
; Between two instructions:
;   X      the next byte of the code
;   Y      where the top of the stack has its place in memory: in `stack`, behind the values below
;   a      the top of the stack itself; means nothing where the stack is empty
;   r1     0
; A statement leaves the stack empty, so it may use a and b as it likes.

#include "layout_avr.h"

#ifdef tiniscript_in_assembly

#include "bytecode_avr.S"
#include "wide_avr.h"

#define vars r4         /* and r5: the first variable */
#define vars1 r5
#define stack_base r6   /* the low byte of Y where the stack is empty */
#define stack_full r7   /* and where it is full */
#define code_end r8     /* and r9 */
#define code_end1 r9
#define at r10          /* and r11: the byte after the opcode that runs, where it is told */
#define at1 r11
#define mode r12        /* what two instructions that share their end differ in */
#define budget r13
#define frame_count r14
#define count0 r16      /* the innermost frame: what is left of a counted loop, 24 bits, or a place */
#define count1 r17
#define count2 r15

; How two numbers compare, and which results a comparator allows.
#define EQUAL 1
#define LESS 2
#define MORE 4

#define GPIOR0 0x1e
#define SPL 0x3d
#define SPH 0x3e

; Goes on with the next instruction. What programs do often does it itself; all else jumps to where
; that is done, which takes two cycles more and 8 bytes less.
.macro next
    ld r30, X+
    ldi r31, 0
    subi r30, pm_lo8(-(table))
    sbci r31, pm_hi8(-(table))
    ijmp
.endm

; Where an instruction begins, r30 still tells its opcode.
.macro let_r30_be_opcode
    subi r30, pm_lo8(table)
.endm

; Points Z to the machine.
.macro let_z_be_machine
    movw r30, vars
    sbiw r30, tini_variables_at
.endm

; Points Z to the variable whose number is in a register, which is overwritten.
.macro let_z_be_variable number, unless
    cpi \number, tini_variables
    brsh \unless
    lsl \number
    lsl \number
    movw r30, vars
    add r30, \number
    adc r31, r1
.endm

.macro load_b_from_z
    ld b0, Z
    ldd b1, Z+1
    ldd b2, Z+2
    ldd b3, Z+3
.endm

.macro load_a_from_z
    ld a0, Z
    ldd a1, Z+1
    ldd a2, Z+2
    ldd a3, Z+3
.endm

.macro load_a_from_y
    ld a0, Y
    ldd a1, Y+1
    ldd a2, Y+2
    ldd a3, Y+3
.endm

.macro store_a_at_z
    st Z, a0
    std Z+1, a1
    std Z+2, a2
    std Z+3, a3
.endm

; The number is in r30.
.macro let_z_be_short_variable
    lsl r30
    lsl r30
    ldi r31, 0
    add r30, vars
    adc r31, vars1
.endm

; Pushes a value: the old top of the stack goes to memory.
.macro push_a unless
    cp r28, stack_full
    breq \unless
    st Y+, a0
    st Y+, a1
    st Y+, a2
    st Y+, a3
.endm

.macro pop_b unless
    cp r28, stack_base
    breq \unless
    ld b3, -Y
    ld b2, -Y
    ld b1, -Y
    ld b0, -Y
.endm

; A value less. Where a statement ends, none is left, so a may keep what it was.
.macro drop unless
    cp r28, stack_base
    breq \unless
    sbiw r28, 4
.endm

    .section .text.tiniscript_execute, "ax", @progbits

; void Machine::execute(uint8_t budget)
    .global _ZN10tiniscript7Machine7executeEh
    .type _ZN10tiniscript7Machine7executeEh, @function
_ZN10tiniscript7Machine7executeEh:
    ldi r26, 0              ; no local variables
    ldi r27, 0
    ldi r30, pm_lo8(1f)
    ldi r31, pm_hi8(1f)
    jmp __prologue_saves__
1:  mov budget, r22
    movw r30, r24
    subi r24, lo8(-tini_variables_at)
    sbci r25, hi8(-tini_variables_at)
    movw vars, r24
    rcall let_y_be_empty
    mov stack_base, r28
    mov r18, r28
    subi r18, -4 * tini_stack_values
    mov stack_full, r18
    ldd r18, Z+tini_length_at
    ldd r19, Z+tini_length_at+1
    rcall let_x_be_code
    add r18, r26
    adc r19, r27
    movw code_end, r18
    rcall add_pc_to_x
    clr frame_count
    ldd r18, Z+tini_depth_at
    ldd r19, Z+tini_frame_count_at
    cpi r18, tini_stack_values + 1
    brsh 2f
    cpi r19, tini_counters + tini_calls + 1
    brsh 2f
    lsl r18
    lsl r18
    add r28, r18
    adc r29, r1
    load_a_from_y
    mov frame_count, r19
    cpse frame_count, r1    ; none: what its registers hold means nothing
    rcall load_frame
    rjmp next_one
2:  adiw r26, 1             ; memory has changed
    rjmp bad_1

; The target of a jump lies outside of the code.
bad_jump:
    adiw r26, 1
    rjmp bad_1
bad_2:
    sbiw r26, 1
op_none:
bad_1:
    ldi r18, tini_fault_bad_code
    rjmp faulted
overflow:
    ldi r18, tini_fault_overflow
; A fault, its number in r18; X stands behind the opcode.
faulted:
    movw at, r26
    sbiw r26, 1
    let_z_be_machine
    std Z+tini_fault_at, r18

; The next instruction is that at X. The last one began before `at`.
leave:
    std Y+0, a0
    std Y+1, a1
    std Y+2, a2
    std Y+3, a3
    rcall store_places
    ldd r18, Z+tini_length_at    ; jumps back do not look where they lead
    ldd r19, Z+tini_length_at+1
    cp r18, r20
    cpc r19, r21
    ldi r18, tini_fault_bad_code
    brsh 1f
    std Z+tini_fault_at, r18
1:  mov r18, r28
    sub r18, stack_base
    lsr r18
    lsr r18
    std Z+tini_depth_at, r18
    std Z+tini_frame_count_at, frame_count
    std Z+tini_budget_left_at, budget
    rcall store_frame
    in r28, SPL
    in r29, SPH
    ldi r30, 18             ; registers
    jmp __epilogue_restores__

; Leaves the places in the machine, which Z is then; r20 and r21 are that of X.
store_places:
    let_z_be_machine
    ldd r18, Z+tini_code_at
    ldd r19, Z+tini_code_at+1
    movw r20, at
    sec                     ; `at` is behind the opcode
    sbc r20, r18
    sbc r21, r19
    std Z+tini_at_at, r20
    std Z+tini_at_at+1, r21
    movw r20, r26
    sub r20, r18
    sbc r21, r19
    std Z+tini_pc_at, r20
    std Z+tini_pc_at+1, r21
    ret

let_x_be_code:
    ldd r26, Z+tini_code_at
    ldd r27, Z+tini_code_at+1
    ret

; For the machine at Z.
let_x_be_next:
    rcall let_x_be_code
add_pc_to_x:
    ldd r0, Z+tini_pc_at
    add r26, r0
    ldd r0, Z+tini_pc_at+1
    adc r27, r0
    ret

let_y_be_empty:
    movw r28, vars
    subi r28, lo8(tini_variables_at - tini_stack_at)
    sbci r29, hi8(tini_variables_at - tini_stack_at)
    ret

; The innermost frame is in registers, those around it are in memory. Without any, it comes from
; before the first one and goes there: the stack's last place, which is empty then.
let_z_be_frame:
    mov r30, frame_count
    lsl r30
    add r30, frame_count
    ldi r31, 0
    subi r30, lo8(tini_variables_at - tini_frames_at + tini_frame_bytes)
    sbci r31, hi8(tini_variables_at - tini_frames_at + tini_frame_bytes)
    add r30, vars
    adc r31, vars1
    ret

; Opens a frame: a0 to a2.
push_frame:
    ldi r20, tini_counters + tini_calls
    cp frame_count, r20
    brsh 1f
    rcall store_frame
    inc frame_count
    movw count0, a0
    mov count2, a2
    ret
1:  rjmp bad_caller

store_frame:
    rcall let_z_be_frame
    st Z, count0
    std Z+1, count1
    std Z+2, count2
    ret

pop_frame:
    dec frame_count
load_frame:
    rcall let_z_be_frame
    ld count0, Z
    ldd count1, Z+1
    ldd count2, Z+2
    ret

; A distance forward or back; T says whether it has two bytes. Leaves the flags.
distance:
    ld r18, X+
    ldi r19, 0
    brtc 1f
    ld r19, X+
1:  ret

#define tini_is_execute
#include "execute_values_avr.S"
#include "execute_statements_avr.S"
#include "execute_control_avr.S"

; The target for each byte of code.
table:
    handlers

#endif
