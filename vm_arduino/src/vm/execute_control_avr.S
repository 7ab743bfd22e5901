; Blocks, loops and procedures.
;
; A part of `execute_avr.S`, which includes it and says what registers are; by itself it is empty.

#ifdef tini_is_execute

op_if:
    drop bad_if
    or a0, a1
    or a0, a2
    or a0, a3
    ld r18, X+
    breq jump_near
    rjmp next_one
op_if_not:
    drop bad_if
    or a0, a1
    or a0, a2
    or a0, a3
    ld r18, X+
    brne jump_near
    rjmp next_one

bad_if:
    rjmp bad_1

op_break_loop_far:
    set
    rjmp 1f
op_break_loop:
    clt
1:  rcall distance
    tst frame_count
    breq bad_if
    rcall pop_frame
    rjmp jump

op_if_far:
    drop bad_if
    set
    call is_a_zero
    rcall distance
    breq jump
    rjmp next_one
op_if_not_far:
    drop bad_if
    set
    call is_a_zero
    rcall distance
    brne jump
    rjmp next_one

op_else_far:
op_break_far:
op_def_far:
tini_of_tasks(op_task:)
tini_of_tasks(op_when:)
    set
    rcall distance
jump:
    add r26, r18
    adc r27, r19
    brcs 1f
    rjmp land
op_else:
op_break:
op_def:
    ld r18, X+
jump_near:
    add r26, r18
    adc r27, r1
land:
    cp code_end, r26
    cpc code_end1, r27
    brlo 1f
next_one:
    next
1:  rjmp bad_jump

op_while_far:
    adiw r26, 1
op_while:
    adiw r26, 1
op_forever:
    rjmp next_one

op_loop8:
    ld a0, X+
    clr a1
    clr a2
push_counter:
    rcall push_frame
    rjmp next_one

bad_loop:
    rjmp bad_1

op_loop_far:
    set
    rjmp 1f
op_loop:
    clt
1:  drop bad_loop
    movw at, r26
    movw b0, a0
    movw b2, a2
    clr r26
    clr r27
    movw r30, r26
    tst a3
    brmi 2f
    call divide_by_1000
2:  movw r26, at
    movw a0, b0
    movw a2, b2
    rcall distance
    tst a3
    brmi jump
    call is_a_zero
    breq jump
    rjmp push_counter

op_next:
    subi count0, 1
    sbci count1, 0
    sbc count2, r1
    breq 2f
op_again:
    ld r18, X+
    dec budget
    breq 1f
    sbic GPIOR0, tini_event_bit
    rjmp 1f
    sub r26, r18
    sbc r27, r1
    next
1:  clt
    ldi r19, 0
    rjmp leave_behind_jump

2:  clt
3:  tst frame_count
    breq bad_back
    rcall pop_frame
    rcall distance
    next
op_next_far:
    set
    subi count0, 1
    sbci count1, 0
    sbc count2, r1
    breq 3b
op_again_far:
    set
    rcall distance
; Jumps back by r18 and r19. The machine leaves if the budget is used up, or if an interrupt has an
; event.
jump_back:
    dec budget
    breq leave_behind_jump
    sbic GPIOR0, tini_event_bit
    rjmp leave_behind_jump
    sub r26, r18
    sbc r27, r19
land_after:                ; also not before the code
    let_z_be_machine
    ldd r18, Z+tini_code_at
    ldd r19, Z+tini_code_at+1
    cp r26, r18
    cpc r27, r19
    brlo bad_back
    rjmp land

bad_back:
    rjmp bad_1

; An instruction of two bytes, or of three where T is set, jumps back.
leave_behind_jump:
    movw r24, r26
    sbiw r24, 1
    brtc 4f
    sbiw r24, 1
4:  movw at, r24
    sub r26, r18
    sbc r27, r19
    rjmp leave

op_call_far:
    set
    rjmp 5f
op_call:
    clt
5:  rcall distance
    movw a0, r26
    rcall push_frame
    rjmp jump_back

op_return:
    tst frame_count
    breq bad_back
    movw r26, count0        ; of a loop where memory has changed
    rcall pop_frame
    rjmp land_after

; uint32_t Drive::late_ms(const TaskRecord* task) const: how far its clock is behind now. The
; compiler takes 54 bytes for it.
    .section .text._ZNK10tiniscript5Drive7late_msEPKNS_10TaskRecordE, "ax", @progbits
    .global _ZNK10tiniscript5Drive7late_msEPKNS_10TaskRecordE
    .type _ZNK10tiniscript5Drive7late_msEPKNS_10TaskRecordE, @function
_ZNK10tiniscript5Drive7late_msEPKNS_10TaskRecordE:
    movw r26, r22
    adiw r26, tini_clock_at
    movw r30, r24
    ldd r22, Z+tini_now_at
    ldd r23, Z+tini_now_at+1
    ldd r24, Z+tini_now_at+2
    ldd r25, Z+tini_now_at+3
    ld r0, X+
    sub r22, r0
    ld r0, X+
    sbc r23, r0
    ld r0, X+
    sbc r24, r0
    ld r0, X
    sbc r25, r0
    ret

    .section .text.tiniscript_execute

#endif
