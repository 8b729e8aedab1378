// A tile that sleeps and is woken every millisecond.
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

ISR(TIMER1_COMPA_vect) {}

int main(void) {
    OCR1A = 15999;
    TCCR1B = 9;
    TIMSK1 = 2;
    set_sleep_mode(SLEEP_MODE_IDLE);
    sei();
    for (;;) {
        sleep_mode();
    }
}
