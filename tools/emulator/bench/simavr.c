// How fast libsimavr runs a program: simavr ELF MEGACYCLES prints its cycles in a microsecond of processor time.
// Never shipped.
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

// A chip that sleeps shall not make this process sleep.
static void pass(avr_t* avr, avr_cycle_count_t cycles) {
    (void)avr, (void)cycles;
}

int main(int argc, char** argv) {
    elf_firmware_t program = {0};
    if (argc != 3 || elf_read_firmware(argv[1], &program) != 0) {
        return 2;
    }
    avr_t* avr = avr_make_mcu_by_name("atmega2560");
    avr_init(avr);
    program.frequency = 16000000;
    avr_load_firmware(avr, &program);
    avr->sleep = pass;
    const avr_cycle_count_t end = strtoull(argv[2], NULL, 10) * 1000000;
    struct timespec from, to;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &from);
    while (avr->cycle < end) {
        const int state = avr_run(avr);
        if (state == cpu_Done || state == cpu_Crashed) {
            fprintf(stderr, "stopped at cycle %llu\n", (unsigned long long)avr->cycle);
            return 1;
        }
    }
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &to);
    const double seconds = (double)(to.tv_sec - from.tv_sec) + (double)(to.tv_nsec - from.tv_nsec) * 1e-9;
    fprintf(stderr, "%f\n", (double)avr->cycle / seconds / 1e6);
    return 0;
}
