; The turns of tasks for an Uno without discs, and their moves.
;
; Means the same as `turns.cpp` and `drive.cpp`, which all other chips run and which name the steps; the
; tests run random programs with both on a simulated ATmega328P. It is here because it takes 430 bytes
; less of flash, a third, and an Uno's image has few left. A chip with more flash in the Uno's place,
; or 430 bytes to spare beside all that an Uno is to learn, lets it go: then delete this file.
;
; Between two steps:
;   Y        the machine
;   current  the record of the task that is looked at, or whose turn it is
;   budget   how many jumps back and calls are left
;   r1       0

#include "layout_avr.h"

#ifdef tiniscript_tasks_in_assembly

#define current r16     /* and r17 */
#define current1 r17
#define budget r15

#define GPIOR0 0x1e

#define late_ms _ZNK10tiniscript5Drive7late_msEPKNS_10TaskRecordE
#define execute _ZN10tiniscript7Machine7executeEh
#define sends _ZN10tiniscript9Scheduler5sendsEv
#define set_motors _ZN10tiniscript5Drive10set_motorsEj
#define wait _ZN10tiniscript5Drive4waitEm
#define comes_to_end _ZN10tiniscript5Drive12comes_to_endEv

; Points Z to something that lies far behind the machine's first byte.
.macro let_z_be at
    movw r30, r28
    subi r30, lo8(-(\at))
    sbci r31, hi8(-(\at))
.endm

    .section .text._ZN10tiniscript7Machine9run_roundEv, "ax", @progbits

; void Machine::run_round()
    .global _ZN10tiniscript7Machine9run_roundEv
    .type _ZN10tiniscript7Machine9run_roundEv, @function
_ZN10tiniscript7Machine9run_roundEv:
    push budget
    push current
    push current1
    push r28
    push r29
    movw r28, r24
    ldd budget, Y+tini_budget_left_at
    ldd current, Y+tini_current_at
    ldd current1, Y+tini_current_at+1
    cp current, r1
    cpc current1, r1
    breq begin_round
    rjmp go_on_with_turn

begin_round:
    ldi r24, 1
    std Y+tini_is_quiet_at, r24
    rcall let_z_be_first
    movw current, r30
    rjmp look_at_task

let_z_be_first:
    let_z_be tini_records_at
    ret

; finds_turn: of the next task.
find_turn:
    let_z_be tini_main_task_at
    cp r30, current
    cpc r31, current1
    brne 1f
    rjmp end_round
1:  subi current, lo8(-tini_record_bytes)
    sbci current1, hi8(-tini_record_bytes)
look_at_task:
    std Y+tini_current_at, current
    std Y+tini_current_at+1, current1
    ; to_the_end
    movw r30, current
    ldd r24, Z+tini_task_frame_count_at
1:  subi r24, 1
    brcs waits_for_clock
    let_z_be tini_frames_at
    ld r18, Z
    ldd r19, Z+1
    ldd r20, Z+2
    ldd r25, Y+tini_frame_count_at
2:  cpi r25, 2
    brlo 3f
    ldd r21, Z+3
    ldd r22, Z+4
    ldd r23, Z+5
    st Z+, r21
    st Z+, r22
    st Z+, r23
    dec r25
    rjmp 2b
3:  st Z, r18
    std Z+1, r19
    std Z+2, r20
    rjmp 1b

waits_for_clock:
    movw r30, current
    ld r24, Z
    sbrc r24, tini_has_time_bit
    rjmp 4f
    sbrs r24, tini_is_moving_bit
    rjmp find_turn
    ldd r18, Y+tini_holder_at
    ldd r19, Y+tini_holder_at+1
    cp r18, current
    cpc r19, current1
    brne find_turn
4:  rcall let_late_be_mine
    sbrc r25, 7
    rjmp find_turn

; begin_turn
    ldd r24, Z+tini_task_frame_count_at
    ldd r25, Y+tini_frame_count_at
    sub r24, r25
    std Z+tini_task_frame_count_at, r24
    ldd r24, Z+tini_task_pc_at
    ldd r25, Z+tini_task_pc_at+1
    std Y+tini_pc_at, r24
    std Y+tini_pc_at+1, r25
    ldd r24, Z+tini_task_code_at
    subi r24, tini_show
    cpi r24, 2
    brsh 5f
    movw r24, r28
    call sends
    cpse r24, r1
    rjmp 8f
9:  rjmp end_turn
8:  movw r30, current
5:  ld r24, Z
    sbrc r24, tini_has_begun_bit
    rjmp 6f
    rcall may_begin
    tst r24
    breq 9b
    ld r24, Z
    sbrc r24, tini_has_time_bit
    rjmp go_on_with_turn
    ori r24, 1 << tini_has_time_bit
    st Z, r24
    rcall set_clock
    ldd r24, Z+tini_task_code_at
    sbrc r24, tini_watches_bit
    rjmp go_on_with_turn
    rcall go_on_with_move
    tst r24
    breq end_turn
    rjmp go_on_with_turn
6:  sbrs r24, tini_to_its_end_bit
    rjmp go_on_with_turn
    rcall end_move

go_on_with_turn:
    tst budget
    breq return
    ldi r22, 1
    movw r24, r28
    call execute
    ldd r24, Y+tini_fault_at
    cpse r24, r1
    rjmp return
    ld r24, Y
    cpi r24, tini_done
    breq return
    ldd r25, Y+tini_budget_left_at
    tst r25
    brne has_stopped
    ; the inner loop leaves at each jump back, where a loop may wait, and at each call
    dec budget
    ldd r26, Y+tini_code_at
    ldd r27, Y+tini_code_at+1
    ldd r18, Y+tini_at_at
    ldd r19, Y+tini_at_at+1
    add r26, r18
    adc r27, r19
    ld r25, X
    cpi r25, tini_call
    brsh 1f
    ; go_back
    rcall has_waited
    brts 1f
    ldi r20, 1
    ldi r21, 0
    ldi r22, 0
    ldi r23, 0
    rcall wait_in_turn
    rcall has_waited
    rjmp end_turn
1:  sbis GPIOR0, tini_event_bit
    rjmp go_on_with_turn
return:
    std Y+tini_budget_left_at, budget
    pop r29
    pop r28
    pop current1
    pop current
    pop budget
    ret

; Lets T be whether the task has waited, and forgets it.
has_waited:
    movw r30, current
    ld r24, Z
    bst r24, tini_has_waited_bit
    andi r24, ~(1 << tini_has_waited_bit) & 0xff
    st Z, r24
    ret

; Before all others the main task waits for a reading, too.
has_stopped:
    ldd r25, Y+tini_other_tasks_at
    sbrs r25, tini_has_had_turn_bit
    cpse r24, r1
    rjmp end_turn
    rjmp return

end_turn:
    movw r30, current
    ldd r24, Y+tini_pc_at
    ldd r25, Y+tini_pc_at+1
    std Z+tini_task_pc_at, r24
    std Z+tini_task_pc_at+1, r25
    ldd r24, Z+tini_task_frame_count_at
    ldd r25, Y+tini_frame_count_at
    add r24, r25
    std Z+tini_task_frame_count_at, r24
    std Y+tini_is_quiet_at, r1
    st Y, r1
    ; pass_on
    rcall let_z_be_first
    ldi r24, tini_tasks
1:  ld r25, Z
    andi r25, tini_wants_motors
    brne 2f
    adiw r30, tini_record_bytes
    dec r24
    brne 1b
2:  ld r24, Z
    sbrc r24, tini_drives_bit
    rjmp find_turn
    ldd r26, Y+tini_holder_at
    ldd r27, Y+tini_holder_at+1
    cp r26, r30
    cpc r27, r31
    breq 3f
    std Y+tini_holder_at, r30
    std Y+tini_holder_at+1, r31
    sbrc r24, tini_has_time_bit
    rjmp 3f
    ldd r18, Y+tini_now_at
    ldd r19, Y+tini_now_at+1
    ldd r20, Y+tini_now_at+2
    ldd r21, Y+tini_now_at+3
    ldd r25, Y+tini_other_tasks_at
    lsr r25                 ; the bit of the first round
    adc r18, r1
    adc r19, r1
    adc r20, r1
    adc r21, r1
    std Z+tini_clock_at, r18
    std Z+tini_clock_at+1, r19
    std Z+tini_clock_at+2, r20
    std Z+tini_clock_at+3, r21
3:  adiw r26, tini_task_own_powers_at
    ld r18, X+
    ld r19, X
    sbrs r24, tini_holds_powers_bit
    std Z+tini_task_own_powers_at, r1
    sbrs r24, tini_holds_powers_bit
    std Z+tini_task_own_powers_at+1, r1
    ldd r22, Z+tini_task_own_powers_at
    ldd r23, Z+tini_task_own_powers_at+1
    cp r18, r22
    cpc r19, r23
    breq 4f
    rcall let_motors_be
4:  rjmp find_turn

end_round:
    ldd r24, Y+tini_other_tasks_at
    sbrs r24, tini_has_had_turn_bit
    rjmp begin_others
    andi r24, ~tini_is_first_round & 0xff
    std Y+tini_other_tasks_at, r24
    std Y+tini_current_at, r1
    std Y+tini_current_at+1, r1
    ldi r24, tini_waiting
    st Y, r24
    rjmp return

begin_others:
    ori r24, 1 << tini_has_had_turn_bit | tini_is_first_round
    std Y+tini_other_tasks_at, r24
    rcall let_z_be_first
    ldi r24, tini_tasks
1:  rcall set_clock
    adiw r30, tini_record_bytes
    dec r24
    brne 1b
    rjmp begin_round

; Sets the clock of the task at Z to now. Leaves r22 to r25.
set_clock:
    ldd r18, Y+tini_now_at
    ldd r19, Y+tini_now_at+1
    ldd r20, Y+tini_now_at+2
    ldd r21, Y+tini_now_at+3
    std Z+tini_clock_at, r18
    std Z+tini_clock_at+1, r19
    std Z+tini_clock_at+2, r20
    std Z+tini_clock_at+3, r21
    ret

; How far the task's own clock is behind now: r22 to r25. Leaves r18 to r21; Z is its record.
let_late_be_mine:
    movw r22, current
    movw r24, r28
    call late_ms
    movw r30, current
    ret

let_motors_be_off:
    ldi r22, 0
    ldi r23, 0
; Sets the motors to the powers in r22 and r23.
let_motors_be:
    movw r24, r28
    jmp set_motors

    .size _ZN10tiniscript7Machine9run_roundEv, . - _ZN10tiniscript7Machine9run_roundEv

    .global tiniscript_moves
    .type tiniscript_moves, @function
tiniscript_moves:
; What C++ calls begins with `rcall enter`, which runs what lies behind that, with Y and `current`.
enter:
    pop r31
    pop r30
    push current
    push current1
    push r28
    push r29
    movw r28, r24
    ldd current, Y+tini_current_at
    ldd current1, Y+tini_current_at+1
    icall
    pop r29
    pop r28
    pop current1
    pop current
    ret

; bool Drive::comes_to_end()
    .global comes_to_end
    .type comes_to_end, @function
comes_to_end:
    rcall enter
    rcall end_move
yes:
    ldi r24, 1
    ret

; bool Drive::wait(uint32_t duration_ms)
    .global wait
    .type wait, @function
wait:
    rcall enter
wait_in_turn:
    movw r30, current
    ldi r24, tini_wait
    std Z+tini_task_code_at, r24
    rjmp drive_in_turn

; bool Drive::drive(uint32_t move_ms)
    .global _ZN10tiniscript5Drive5driveEm
    .type _ZN10tiniscript5Drive5driveEm, @function
_ZN10tiniscript5Drive5driveEm:
    rcall enter
drive_in_turn:
    rcall keep_move
    tst r24
    brne go_on_with_move
    ret
; go_on, where it may begin
go_on_with_move:
    movw r30, current
    ld r24, Z
    sbrc r24, tini_has_begun_bit
    rjmp 3f
    ldd r24, Z+tini_task_code_at
    sbrc r24, tini_waits_bit
    rjmp 2f
    rcall take_motors
    movw r30, current
    ld r24, Z
    ori r24, 1 << tini_is_moving_bit | 1 << tini_drives_bit
    st Z, r24
    ; powers_of_move
    ldd r24, Z+tini_task_code_at
    ldd r22, Z+tini_task_power_at
    sbrc r22, 7
    ldi r22, 0
    sbrc r24, 0
    neg r22
    mov r23, r22
    sbrc r24, 1
    neg r22
    rcall let_motors_be
    movw r30, current
2:  ld r24, Z
    ori r24, 1 << tini_has_begun_bit
    st Z, r24
    ; begin
    rcall let_late_be_mine
    cpi r22, tini_late_ms + 1
    cpc r23, r1
    cpc r24, r1
    cpc r25, r1
    brlo 3f
    rcall set_clock
3:  ; the next check that is not late; rarely more than one
    rcall let_late_be_mine
    ldd r18, Z+tini_task_rest_at
    ldd r19, Z+tini_task_rest_at+1
    ldd r20, Z+tini_task_rest_at+2
    ldd r21, Z+tini_task_rest_at+3
    ldd r0, Z+tini_task_code_at
    sbrs r0, tini_watches_bit
    rjmp 5f
    cpi r18, tini_check_ms + 1
    cpc r19, r1
    cpc r20, r1
    cpc r21, r1
    brlo 5f
    ldi r18, tini_check_ms
    clr r19
    clr r20
    clr r21
    rcall let_pass
    cpi r22, tini_check_ms
    cpc r23, r1
    cpc r24, r1
    cpc r25, r1
    brsh 3b
    ld r24, Z
    sbrs r24, tini_drives_bit
    rjmp 4f
    ldd r24, Y+tini_pc_at
    ldd r25, Y+tini_pc_at+1
    std Y+tini_move_end_at, r24
    std Y+tini_move_end_at+1, r25
4:  rcall go_to_check
    rjmp 8f
5:  ; its end
    ld r24, Z
    sbrs r24, tini_drives_bit
    rjmp 6f
    ori r24, 1 << tini_to_its_end_bit
    st Z, r24
6:  mov r0, r18
    or r0, r19
    or r0, r20
    or r0, r21
    brne 7f
    ldd r0, Y+tini_other_tasks_at
    tst r0
    breq 7f
    sbrc r24, tini_to_its_end_bit
    rcall end_move
    rjmp yes
7:  rcall let_pass
8:  ld r24, Z
    ori r24, 1 << tini_has_waited_bit
    st Z, r24
pause:
    ldi r24, tini_waiting
    st Y, r24
no:
    ldi r24, 0
    ret

; Lets the milliseconds in r18 to r21 pass for the task at Z, and for its move. Leaves r22 to r25.
let_pass:
    ldd r0, Z+tini_clock_at
    add r0, r18
    std Z+tini_clock_at, r0
    ldd r0, Z+tini_clock_at+1
    adc r0, r19
    std Z+tini_clock_at+1, r0
    ldd r0, Z+tini_clock_at+2
    adc r0, r20
    std Z+tini_clock_at+2, r0
    ldd r0, Z+tini_clock_at+3
    adc r0, r21
    std Z+tini_clock_at+3, r0
    ldd r0, Z+tini_task_rest_at+3
    sbrc r0, 7              ; for ever
    ret
    ldd r0, Z+tini_task_rest_at
    sub r0, r18
    std Z+tini_task_rest_at, r0
    ldd r0, Z+tini_task_rest_at+1
    sbc r0, r19
    std Z+tini_task_rest_at+1, r0
    ldd r0, Z+tini_task_rest_at+2
    sbc r0, r20
    std Z+tini_task_rest_at+2, r0
    ldd r0, Z+tini_task_rest_at+3
    sbc r0, r21
    std Z+tini_task_rest_at+3, r0
    ret

; bool Drive::watch(uint32_t move_ms)
    .global _ZN10tiniscript5Drive5watchEm
    .type _ZN10tiniscript5Drive5watchEm, @function
_ZN10tiniscript5Drive5watchEm:
    rcall enter
    movw r30, current
    ldd r24, Z+tini_task_code_at
    ori r24, 1 << tini_watches_bit
    std Z+tini_task_code_at, r24
; keep_move: the time is in r20 to r23. Returns what `may_begin` does.
keep_move:
    movw r30, current
    std Z+tini_task_rest_at, r20
    std Z+tini_task_rest_at+1, r21
    std Z+tini_task_rest_at+2, r22
    std Z+tini_task_rest_at+3, r23
    ldd r24, Y+tini_pc_at
    ldd r25, Y+tini_pc_at+1
    std Z+tini_task_check_at, r24
    std Z+tini_task_check_at+1, r25
    ld r24, Z
    andi r24, ~(1 << tini_has_begun_bit) & 0xff
    st Z, r24
; The opposite of `blocks`: r24 is 0 where it does. Z is the task's record.
may_begin:
    ldd r24, Z+tini_task_code_at
    sbrc r24, tini_waits_bit
    rjmp yes
    rcall is_below
    brlo 1f
    rjmp yes
1:  rcall want
    andi r24, ~(1 << tini_has_time_bit) & 0xff
    ori r24, 1 << tini_is_moving_bit | 1 << tini_has_waited_bit
    st Z, r24
    rcall go_to_check
    rjmp pause

go_to_check:
    ldd r24, Z+tini_task_check_at
    ldd r25, Z+tini_task_check_at+1
    std Y+tini_pc_at, r24
    std Y+tini_pc_at+1, r25
    ret

; Sets the carry where a higher task has the motors.
is_below:
    ldd r18, Y+tini_holder_at
    ldd r19, Y+tini_holder_at+1
    cp r18, current
    cpc r19, current1
    ret

; Leaves r18 to r23; r24 is the state of the task, whose record Z is.
want:
    movw r30, current
    ld r24, Z
    andi r24, ~(1 << tini_holds_powers_bit) & 0xff
    ldd r25, Z+tini_task_start_at
    ldd r0, Z+tini_task_start_at+1
    or r0, r25
    breq 1f
    ori r24, 1 << tini_keeps_bit
1:  st Z, r24
    ret

take_motors:
    rcall want
    ldd r30, Y+tini_holder_at
    ldd r31, Y+tini_holder_at+1
    std Y+tini_holder_at, current
    std Y+tini_holder_at+1, current1
    ld r24, Z
    sbrs r24, tini_drives_bit
    ret
; stand_still: of the task at Z.
    movw r18, r30
    movw r22, r30
    movw r24, r28
    call late_ms
    movw r30, r18
    ldd r18, Z+tini_task_rest_at
    ldd r19, Z+tini_task_rest_at+1
    ldd r20, Z+tini_task_rest_at+2
    ldd r21, Z+tini_task_rest_at+3
    sbrc r21, 7             ; for ever
    rjmp 1f
    sub r18, r22
    sbc r19, r23
    sbc r20, r24
    sbc r21, r25
    breq leave_move
    brmi leave_move
    std Z+tini_task_rest_at, r18
    std Z+tini_task_rest_at+1, r19
    std Z+tini_task_rest_at+2, r20
    std Z+tini_task_rest_at+3, r21
1:  ld r24, Z
    andi r24, ~(1 << tini_has_time_bit | 1 << tini_drives_bit | 1 << tini_has_begun_bit | 1 << tini_to_its_end_bit) & 0xff
    st Z, r24
    ldd r24, Z+tini_task_check_at
    ldd r25, Z+tini_task_check_at+1
    rjmp 2f
; Of the task at Z, which goes on behind it.
leave_move:
    rcall forget_move
    sbrc r24, tini_to_its_end_bit
    ret
    ldd r24, Y+tini_move_end_at
    ldd r25, Y+tini_move_end_at+1
2:  std Z+tini_task_pc_at, r24
    std Z+tini_task_pc_at+1, r25
    ret

; end_move_of: of the task at Z, whose state r24 was.
forget_move:
    ld r24, Z
    mov r25, r24
    andi r25, ~(1 << tini_holds_powers_bit | 1 << tini_is_moving_bit | 1 << tini_drives_bit | 1 << tini_to_its_end_bit) & 0xff
    st Z, r25
    ret

end_move:
    movw r30, current
    rcall forget_move
    sbrs r24, tini_drives_bit
    ret
    rjmp let_motors_be_off

; bool Drive::until(bool stop)
    .global _ZN10tiniscript5Drive5untilEb
    .type _ZN10tiniscript5Drive5untilEb, @function
_ZN10tiniscript5Drive5untilEb:
    rcall enter
    tst r22
    breq go_on_with_move_near
    movw r30, current
    ld r24, Z
    sbrc r24, tini_has_begun_bit
    rcall set_clock
    ori r24, 1 << tini_has_begun_bit
    st Z, r24
    sbrc r24, tini_is_moving_bit
    rcall end_move
    rjmp yes
go_on_with_move_near:
    rjmp go_on_with_move

; void Drive::motors(Powers powers)
    .global _ZN10tiniscript5Drive6motorsEj
    .type _ZN10tiniscript5Drive6motorsEj, @function
_ZN10tiniscript5Drive6motorsEj:
    rcall enter
    rcall is_below
    brlo 1f
    push r22
    push r23
    rcall take_motors
    pop r23
    pop r22
    rcall let_motors_be     ; and so the task's own
    movw r30, current
    rjmp 2f
1:  rcall want
    std Z+tini_task_own_powers_at, r22
    std Z+tini_task_own_powers_at+1, r23
2:  ld r24, Z
    ori r24, 1 << tini_holds_powers_bit
    st Z, r24
    ret

; void Drive::stop_motors()
    .global _ZN10tiniscript5Drive11stop_motorsEv
    .type _ZN10tiniscript5Drive11stop_motorsEv, @function
_ZN10tiniscript5Drive11stop_motorsEv:
    rcall enter
    rcall want
    rcall is_below
    brlo 1f
    rcall let_motors_be_off
    ldd r30, Y+tini_holder_at
    ldd r31, Y+tini_holder_at+1
    ld r24, Z
    andi r24, ~(1 << tini_holds_powers_bit) & 0xff
    st Z, r24
    sbrs r24, tini_drives_bit
1:  ret
    rcall leave_move
    rjmp set_clock

    .size tiniscript_moves, . - tiniscript_moves

#endif
