; Variables, comparisons with constants, and what asks something of the robot.
;
; A part of `execute_avr.S`, which includes it and says what registers are; by itself it is empty.

#ifdef tini_is_execute

; -- variables

op_set_var_short:
    drop bad_set1
    let_r30_be_opcode
    andi r30, tini_shorts - 1
    let_z_be_short_variable
    store_a_at_z
    next

bad_set1:
    rjmp bad_1

op_set_var:
    drop bad_set1
    ld r18, X+
    let_z_be_variable r18, bad_set
    store_a_at_z
    rjmp next_one

op_set_var8:
    ld mode, X+
    rcall let_a_be_thousandths_of_byte
    mov r18, mode
    let_z_be_variable r18, bad_set
    store_a_at_z
    rjmp next_one

bad_set:
    rjmp bad_2

op_inc_var:
    movw at, r26
    ld r18, X+
    let_z_be_variable r18, bad_set
    load_a_from_z
    subi a0, lo8(-1000)
    sbci a1, hi8(-1000)
    sbci a2, -1
    sbci a3, -1
    brvs 1f
    store_a_at_z
    next

op_dec_var:
    movw at, r26
    ldi a0, lo8(-1000)
    ldi a1, hi8(-1000)
    ldi a2, -1
    ldi a3, -1
    ld r18, X+
    rjmp add_a
op_add_var8:
    movw at, r26
    ld mode, X+
    rcall let_a_be_thousandths_of_byte
    mov r18, mode
add_a:
    let_z_be_variable r18, bad_add
add_a_to_z:
    load_b_from_z
    add a0, b0
    adc a1, b1
    adc a2, b2
    adc a3, b3
    brvs 1f
    store_a_at_z
    next
1:  movw r26, at
    rjmp overflow
bad_add:
    movw r26, at
    rjmp bad_1

op_add_var:
    movw at, r26
    ld r18, X+
    ld r19, X+
    let_z_be_variable r19, bad_add
    load_a_from_z
    let_z_be_variable r18, bad_add
    rjmp add_a_to_z

; -- the robot

op_read_short:
    movw at, r26
    let_r30_be_opcode
    andi r30, tini_shorts - 1
    mov r22, r30
    rjmp 1f
op_read:
    movw at, r26
    ld r22, X+
1:  rcall sense
    breq 2f
    rjmp next_one
2:  rjmp stay

; A statement that C++ does, of four bytes, of three, of two, of one.
    acts_of_4
    movw at, r26
    adiw r26, 3
    rjmp 3f
    acts_of_3
    movw at, r26
    adiw r26, 2
    rjmp 3f
    acts_of_2
op_way:
    movw at, r26
    adiw r26, 1
    rjmp 3f
op_end:
tini_of_tasks(op_look:)
tini_of_tasks(op_end_task:)
tini_of_tasks(op_end_when:)
    acts_of_1
    movw at, r26
3:  rcall perform
statement_end:
    rcall let_y_be_empty
    tst r18
    brne 4f
    rjmp leave
4:  rjmp next_one

; A value that could not be sent stays on the stack, but a task has kept it, and goes on behind it.
op_show:
op_show_yes_no:
    movw at, r26
    rcall perform
    tst r18
    brne statement_end
    tini_of_tasks(cp r26, at)
    tini_of_tasks(cpc r27, at1)
    tini_of_tasks(breq statement_end)
    rjmp leave

op_until:
    movw at, r26
    call is_a_zero
    rjmp 5f
op_until16:
    set
    rjmp 6f
op_until8:
    clt
6:  movw at, r26
    rcall compare_a
5:  ldi r18, 0
    breq 7f
    inc r18
7:  mov mode, r18
    rcall before_call
    mov r22, mode
    call _ZN10tiniscript5Drive5untilEb
    rcall after_call
    rjmp statement_end

; Lets C++ do the instruction before `at`; X, which is where the next one begins, may be elsewhere
; then. r18 is 0 where nothing more may run now; a is what lies on top.
perform:
    rcall before_call
    movw r30, at
    ld r22, -Z              ; the opcode
    movw r20, r30           ; the instruction
    movw r18, r28           ; the top of the stack
    call _ZN10tiniscript7Machine3actEhPKhPl
after_call:
    mov r18, r24
    let_z_be_machine
    load_a_from_y
    rjmp let_x_be_next

; The first argument is the machine, which holds its state.
before_call:
    std Y+0, a0
    std Y+1, a1
    std Y+2, a2
    std Y+3, a3
    rcall store_places
    movw r24, r30
    ret

; -- compare and branch

op_if16:
    set
    rjmp 1f
op_if8:
    clt
1:  drop bad_compare
    rcall compare_a
    rjmp 4f

op_if_var16:
    set
    rjmp 2f
op_if_var8:
    clt
2:  let_r30_be_opcode
    mov mode, r30
    ld r18, X+
    let_z_be_variable r18, bad_compare2
    rcall compare
4:  ld r18, X+
    brne 5f
    rjmp jump_near
5:  rjmp next_one
bad_compare2:
    sbiw r26, 1
bad_compare:
    rjmp bad_1

; As `compare`, with a, where an instruction begins.
compare_a:
    let_r30_be_opcode
    mov mode, r30
    std Y+0, a0
    std Y+1, a1
    std Y+2, a2
    std Y+3, a3
    movw r30, r28
; The number at Z with the constant at X, of two bytes where T is set, as the opcode in `mode` says.
; Leaves Z, the flag, where that is FALSE.
compare:
    ld a0, X+
    ldi a1, 0
    brtc 1f
    ld a1, X+
1:  rcall let_a_be_thousandths
    mov r18, mode
    andi r18, tini_comparator_bits
    cpi r18, tini_comparator_lt
    brsh 2f                 ; LT to GE are what they allow
    sbrc r18, 0
    ldi r18, LESS + MORE - EQUAL
    inc r18                 ; EQ and NE become what they allow
2:  ld r0, Z
    cp r0, a0
    ldd r0, Z+1
    cpc r0, a1
    ldd r0, Z+2
    cpc r0, a2
    ldd r0, Z+3
    cpc r0, a3
    ldi r19, EQUAL
    breq 3f
    ldi r19, LESS
    brlt 3f
    ldi r19, MORE
3:  and r19, r18
    ret

#if tini_comparator_eq != 0 || tini_comparator_ne != 1 || tini_comparator_lt != LESS || \
    tini_comparator_le != (LESS | EQUAL) || tini_comparator_gt != MORE || tini_comparator_ge != (MORE | EQUAL)
#error "comparators are not what they allow"
#endif

; a is the signed byte at X, times 1000. Leaves Z.
let_a_be_thousandths_of_byte:
    ld a0, X+
    mov a1, a0
    lsl a1
    sbc a1, a1
; a is the signed word in a0 and a1, times 1000. Leaves Z.
let_a_be_thousandths:
    ldi b0, lo8(1000)
    ldi b1, hi8(1000)
    mul a0, b0
    movw b2, r0
    mulsu a1, b1
    mov a3, r1
    mov a2, r0
    mulsu a1, b0
    sbc a1, a1              ; the sign: `mulsu` leaves it as carry
    add b3, r0
    adc a2, r1
    adc a3, a1
    mul a0, b1
    add b3, r0
    adc a2, r1
    clr r1
    adc a3, r1
    movw a0, b2
    ret

#endif
