; Instructions that are part of an expression.
;
; A part of `execute_avr.S`, which includes it and says what registers are; by itself it is empty.

#ifdef tini_is_execute

op_push_num:
    rcall push_value
    let_r30_be_opcode
    subi r30, tini_push_num_0
    mov a0, r30
    cpi a0, 11              ; 0 to 10, then tens from 20 on
    brlo 1f
    subi a0, 9
    ldi r18, 10
    mul a0, r18
    mov a0, r0
    rjmp 1f
op_push8:
    rcall push_value
    ld a0, X+
1:  ldi a1, 0
thousandths_next:
    rcall let_a_be_thousandths
    rjmp next_one

op_push_tenths:
    rcall push_value
    ld b0, X+
    ldi b1, 100
    mulsu b0, b1
    movw a0, r0
    clr r1
    rjmp sign_next

op_push16:
    rcall push_value
    ld a0, X+
    ld a1, X+
    rjmp thousandths_next

op_push32:
    rcall push_value
    ld a0, X+
    ld a1, X+
    ld a2, X+
    ld a3, X+
    rjmp next_one

op_push_milli:
    rcall push_value
    ld a0, X+
    ld a1, X+
sign_next:                  ; a0 and a1 are all of it
    mov a2, a1
    lsl a2
    sbc a2, a2
    mov a3, a2
    rjmp next_one

op_push_false:
    ldi r18, 0
    rjmp 1f
op_push_true:
    ldi r18, 1
1:  push_a bad_push
    tst r18
truth:                      ; FALSE where Z is set
    ldi a0, 0
    breq 1f
    ldi a0, 1
1:  ldi a1, 0
    ldi a2, 0
    ldi a3, 0
    rjmp next_one

bad_variable:
    rjmp bad_2

bad_push:
    rjmp bad_1

op_push_var_short:
    push_a bad_push
    let_r30_be_opcode
    andi r30, tini_shorts - 1
    let_z_be_short_variable
    load_a_from_z
    next

op_push_var:
    rcall push_value
    ld r18, X+
    let_z_be_variable r18, bad_variable
push_z:
    load_a_from_z
    next

op_push_sensor_short:
    rcall push_value
    let_r30_be_opcode
    andi r30, tini_shorts - 1
    mov r18, r30
    rjmp 1f
op_push_sensor:
    rcall push_value
    ld r18, X+
1:  rcall let_z_be_reading
    brlo push_z
    rjmp bad_1
op_push_read_short:
    rcall push_value
    movw at, r26
    let_r30_be_opcode
    andi r30, tini_shorts - 1
    mov r22, r30
    rjmp 2f
op_push_read:
    rcall push_value
    movw at, r26
    ld r22, X+
2:  mov mode, r22
    rcall sense
    mov r18, mode
    brne 1b
    sbiw r28, 4             ; as it was before
    load_a_from_y
stay:
    movw r26, at
    sbiw r26, 1
    rjmp leave

; Lets Z be the reading whose number is in r18. Leaves a carry where there is one.
let_z_be_reading:
    let_z_be_machine
    ldd r19, Z+tini_sensors_at
    ldd r20, Z+tini_readings_at
    ldd r21, Z+tini_readings_at+1
    movw r30, r20
    mov r0, r18
    lsl r0
    lsl r0
    add r30, r0
    adc r31, r1
    cp r18, r19
    ret

; Takes a reading of the sensor whose number is in r22. Leaves Z, the flag, where it is not there
; yet.
sense:
    movw part0, r26
    let_z_be_machine
    movw r24, r30
    call _ZN10tiniscript7Machine5senseEh
    movw r26, part0
    tst r24
    ret

op_time:
    rcall push_value
    movw at, r26
    rcall perform
    tst r18
    breq 1f
    rjmp next_one
op_random:
    movw at, r26
    rcall perform
    tst r18
    breq 1f
    rcall pop               ; what comes out lies below
    rjmp let_a_be_b
1:  rjmp leave

; Pops b from the stack.
pop:
    pop_b bad_caller
    ret

; Gives a its place in memory: it is not the top any more.
push_value:
    push_a bad_caller
    ret

; A run-time check has failed in a subroutine of an instruction.
bad_caller:
    pop r0
    pop r0
    tini_of_far_code(pop r0)
bad_pop:
    rjmp bad_1

op_add:
    pop_b bad_pop
    add a0, b0
    adc a1, b1
    adc a2, b2
    adc a3, b3
    brvs 1f
    next
1:  rjmp overflow

op_sub:
    rcall pop
    sub b0, a0
    sbc b1, a1
    sbc b2, a2
    sbc b3, a3
    brvs 1b
let_a_be_b:
    movw a0, b0
    movw a2, b2
    next

op_abs:
    sbrs a3, 7
    rjmp 2f
op_neg:
    call negate_a
    brvs 1b
2:  rjmp next_one

op_min:
    ldi r30, LESS
    rjmp 3f
op_max:
    ldi r30, MORE
3:  rcall relate
    brne let_a_be_b
    rjmp next_one

; b, from the stack, and a: leaves Z, the flag, where they do not relate as r30 allows.
relate:
    pop_b bad_caller
    cp b0, a0
    cpc b1, a1
    cpc b2, a2
    cpc b3, a3
    ldi r31, EQUAL
    breq 4f
    ldi r31, LESS
    brlt 4f
    ldi r31, MORE
4:  and r31, r30
    ret

op_eq:
    ldi r30, EQUAL
    rjmp 5f
op_ne:
    ldi r30, LESS | MORE
    rjmp 5f
op_lt:
    ldi r30, LESS
    rjmp 5f
op_le:
    ldi r30, LESS | EQUAL
    rjmp 5f
op_gt:
    ldi r30, MORE
    rjmp 5f
op_ge:
    ldi r30, MORE | EQUAL
5:  rcall relate
    rjmp truth

op_not:
    call is_a_zero
    ldi a0, 1
    breq 6f
    ldi a0, 0
6:  tst a0
    rjmp truth

op_and:
    rcall pop
    call is_b_zero
    breq 7f
    call is_a_zero
7:  rjmp truth

op_or:
    rcall pop
    call is_b_zero
    brne 7b
    call is_a_zero
    rjmp truth

op_mul:
    rcall pop
    movw at, r26
    call fixed_multiply
    rjmp 9f
op_div:
    rcall pop
    call is_a_zero
    breq 8f
    movw at, r26
    call fixed_divide
    rjmp 9f
op_mod:
    rcall pop
    call is_a_zero
    breq 8f
    movw at, r26
    call fixed_modulo
    rjmp 9f
op_round:
    rcall pop
    movw at, r26
    call fixed_round
9:  movw r26, at
    brcs 1f
    rjmp next_one
1:  rjmp overflow
8:  ldi r18, tini_fault_divide_by_zero
    rjmp faulted

op_and_then_far:
    set
    rjmp 1f
op_and_then:
    clt
1:  rcall distance
    call is_a_zero
    brne pop_a
    rjmp jump
op_or_else_far:
    set
    rjmp 1f
op_or_else:
    clt
1:  rcall distance
    call is_a_zero
    breq pop_a
    rjmp jump
pop_a:
    rcall pop
    rjmp let_a_be_b

#endif
