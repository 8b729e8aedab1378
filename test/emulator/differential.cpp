// Our core and libsimavr side by side: random single instructions, or a program instruction by instruction.
//
//   differential random COUNT SEED      single instructions, each from a random state
//   differential stream COUNT SEED      random instructions one after the other: flags and registers live on
//   differential program ELF COUNT      a program without its peripherals, instruction by instruction
//   differential whole ELF MEGACYCLES   a program with its peripherals: what it says and what it leaves in
//   EEPROM
//   differential both ELF MEGACYCLES    tells what a program says on either
//
// Prints what was compared and exits 0, or prints the first disagreements and exits 1. Instructions that
// reach into peripherals are left out: what those do is tested against the data sheet.
#include "avr/alu.h"
#include "avr/chip.h"
#include "avr/flow.h"
#include "avr/memory.h"
#include "avr/registers.h"
#include "image/image.h"
#include "tile/tile.h"

extern "C" {
#include <simavr/avr_eeprom.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_core.h>
}

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

using namespace tilenca;
using namespace tilenca::avr;

namespace {

constexpr unsigned kPc = 0x100, kMostReports = 10;
constexpr uint16_t kPlainIo[] = {0x3E, 0x4A, 0x4B, 0x5B, 0x5D, 0x5E, 0x5F}; // GPIOR0-2, RAMPZ, SP, SREG

struct Pair {
    avr_t* theirs;
    std::shared_ptr<Program> program = std::make_shared<Program>();
    std::unique_ptr<Chip> ours;

    Pair() : theirs(avr_make_mcu_by_name("atmega2560")) {
        avr_init(theirs);
        theirs->log = 0;
        ours = std::make_unique<Chip>(program, Fuses{});
    }
    void put_word(uint32_t word, uint16_t value) {
        const uint8_t bytes[2] = {static_cast<uint8_t>(value), static_cast<uint8_t>(value >> 8)};
        program->write(2 * word, bytes, 2);
        std::memcpy(theirs->flash + 2 * word, bytes, 2);
    }
};

uint8_t their_status(const avr_t* avr) {
    unsigned value = 0;
    for (unsigned i = 0; i < 8; i++) {
        value |= static_cast<unsigned>(avr->sreg[i] != 0) << i;
    }
    return static_cast<uint8_t>(value);
}

uint16_t their_stack(const avr_t* avr) {
    return static_cast<uint16_t>(avr->data[0x5D] | avr->data[0x5E] << 8);
}

bool touches_io(const Instruction& in) {
    const Handler run = in.run;
    if (run != ops::in && run != ops::out && run != ops::sbi && run != ops::cbi && run != ops::sbic &&
        run != ops::sbis) {
        return false;
    }
    for (const uint16_t address : kPlainIo) {
        if (in.k == address) {
            return false;
        }
    }
    return true;
}

// Loads and stores that step the pointer they move: the instruction set manual leaves the result open.
bool is_undefined(uint16_t opcode) {
    if ((opcode & 0xFC00) != 0x9000) {
        return false;
    }
    const unsigned pair = (opcode >> 4 & 31) & ~1u;
    switch (opcode & 15) {
    case 1:
    case 2:
    case 5:
    case 7:
        return pair == 30;
    case 9:
    case 10:
        return pair == 28;
    case 13:
    case 14:
        return pair == 26;
    default:
        return false;
    }
}

bool is_comparable(uint16_t opcode, const Instruction& in) {
    const Handler run = in.run;
    return !is_undefined(opcode) && run != ops::illegal && run != ops::erased && run != ops::sleep &&
           run != ops::break_ && run != ops::wdr && run != ops::spm && run != ops::spm_plus &&
           !touches_io(in);
}

// Random state, the same on both sides; pointers lead into SRAM, also after displacement.
void randomise(Pair& pair, std::mt19937& random, bool sram_address) {
    Cpu& cpu = pair.ours->cpu();
    avr_t* avr = pair.theirs;
    const auto byte = [&random] { return static_cast<uint8_t>(random()); };
    const auto address = [&random] { return 0x210 + random() % 0x1F00; };
    for (unsigned i = 0; i < 32; i++) {
        cpu.data[i] = byte();
    }
    for (const unsigned pointer : {26u, 28u, 30u}) {
        const unsigned value = sram_address ? address() : static_cast<unsigned>(random() & 0xFFFF);
        cpu.data[pointer] = static_cast<uint8_t>(value);
        cpu.data[pointer + 1] = static_cast<uint8_t>(value >> 8);
    }
    for (const uint16_t io : kPlainIo) {
        cpu.data[io] = byte();
    }
    cpu.data[0x5B] = byte() & 3;
    cpu.data[0x5C] = byte() & 1;
    const unsigned stack = address();
    cpu.data[0x5D] = static_cast<uint8_t>(stack);
    cpu.data[0x5E] = static_cast<uint8_t>(stack >> 8);
    for (unsigned i = 0; i < 4; i++) { // return addresses within flash
        cpu.data[stack + i] = i == 1 ? byte() & 1 : byte();
    }
    const uint8_t status = byte() & 0x7F;
    cpu.set_status(status);
    std::memcpy(avr->data, cpu.data, kDataBytes);
    for (unsigned i = 0; i < 8; i++) {
        avr->sreg[i] = status >> i & 1;
    }
    avr->data[0x5F] = status;
    avr->pc = 2 * kPc;
    avr->cycle = 0;
    avr->state = cpu_Running;
    avr->interrupt_state = 0;
    cpu.at = cpu.program + kPc;
    cpu.cycle = 0;
    cpu.asleep = false;
}

bool agree(Pair& pair, uint64_t start, const char* what, unsigned* reports) {
    Cpu& cpu = pair.ours->cpu();
    avr_t* avr = pair.theirs;
    const uint64_t our_cycles = cpu.cycle - start, their_cycles = avr->cycle - start;
    cpu.data[0x5F] = avr->data[0x5F] = 0;         // kept elsewhere by both
    for (const uint16_t address : {0x5B, 0x5C}) { // RAMPZ and EIND: libsimavr keeps bits that do not exist
        avr->data[address] &= kRegisters.implemented[address];
    }
    const bool memory = std::memcmp(cpu.data, avr->data, kDataBytes) == 0;
    if (memory && cpu.status() == their_status(avr) && 2 * cpu.pc() == avr->pc % kFlashBytes &&
        our_cycles == their_cycles) {
        return true;
    }
    if ((*reports)++ < kMostReports) {
        std::printf(
            "%s: pc %05X / %05X, sreg %02X / %02X, cycles %llu / %llu, sp %04X / %04X (ours / simavr)\n",
            what, 2 * cpu.pc(), avr->pc, cpu.status(), their_status(avr),
            static_cast<unsigned long long>(our_cycles), static_cast<unsigned long long>(their_cycles),
            cpu.data[0x5D] | cpu.data[0x5E] << 8, their_stack(avr));
        for (unsigned i = 0; i < kDataBytes; i++) {
            if (cpu.data[i] != avr->data[i]) {
                std::printf("  data %04X: %02X / %02X\n", i, cpu.data[i], avr->data[i]);
                break;
            }
        }
    }
    return false;
}

int run_random(unsigned count, unsigned seed) {
    Pair pair;
    std::mt19937 random(seed);
    unsigned compared = 0, reports = 0;
    std::map<Handler, unsigned> seen;
    for (unsigned i = 0; i < 512; i++) { // something to read by LPM
        pair.put_word(i, static_cast<uint16_t>(random()));
    }
    while (compared < count) {
        const auto opcode = static_cast<uint16_t>(random());
        const auto next = static_cast<uint16_t>(random() % 4 == 0 ? 0x940E : 0x0210 + random() % 0x1F00);
        const Instruction in = decode(opcode, next, kPc);
        const bool far = in.run == ops::jmp || in.run == ops::call;
        // LDS and STS need an address in SRAM; a far target its highest bit clear: simavr does not wrap it.
        const bool direct = in.run == ops::lds || in.run == ops::sts;
        if (!is_comparable(opcode, in) || (direct && next >= 0x2110) || (far && (opcode & 0x01F0) != 0)) {
            continue;
        }
        pair.put_word(kPc, opcode);
        pair.put_word(kPc + 1, next);
        randomise(pair, random, in.run != ops::ijmp && in.run != ops::icall);
        pair.ours->step();
        avr_t* avr = pair.theirs;
        avr->pc = avr_run_one(avr);
        char what[32];
        std::snprintf(what, sizeof what, "%04X %04X", opcode, next);
        agree(pair, 0, what, &reports);
        seen[in.run]++;
        compared++;
    }
    std::printf("%u instructions of %zu kinds compared, %u disagree\n", compared, seen.size(), reports);
    return reports == 0 ? 0 : 1;
}

bool reaches_memory(const Instruction& in) {
    const Handler run = in.run;
    for (const Handler one :
         {ops::ld_x,  ops::ld_x_plus, ops::ld_minus_x, ops::ldd_y,  ops::ld_y_plus, ops::ld_minus_y,
          ops::ldd_z, ops::ld_z_plus, ops::ld_minus_z, ops::st_x,   ops::st_x_plus, ops::st_minus_x,
          ops::std_y, ops::st_y_plus, ops::st_minus_y, ops::std_z,  ops::st_z_plus, ops::st_minus_z,
          ops::ijmp,  ops::icall,     ops::eijmp,      ops::eicall, ops::push,      ops::pop,
          ops::call,  ops::rcall,     ops::ret,        ops::reti}) {
        if (run == one) {
            return true;
        }
    }
    return false;
}

// Pointers and stack lead into SRAM again, return addresses and targets into the stream; the same on both
// sides.
void lead_back(Pair& pair, std::mt19937& random, unsigned words) {
    Cpu& cpu = pair.ours->cpu();
    const auto put = [&](unsigned at, unsigned value) {
        cpu.data[at] = pair.theirs->data[at] = static_cast<uint8_t>(value);
        cpu.data[at + 1] = pair.theirs->data[at + 1] = static_cast<uint8_t>(value >> 8);
    };
    const auto address = [&random] { return 0x410 + static_cast<unsigned>(random() % 0x1B00); };
    put(26, address());
    put(28, address());
    put(30, 0x400 + random() % (words - 0x400)); // an address in SRAM, and a word of the stream
    cpu.data[0x5C] = pair.theirs->data[0x5C] = 0;
    const unsigned stack = address();
    put(0x5D, stack);
    const auto back = static_cast<unsigned>(random() % words);
    cpu.data[stack + 1] = pair.theirs->data[stack + 1] = 0;
    cpu.data[stack + 2] = pair.theirs->data[stack + 2] = static_cast<uint8_t>(back >> 8);
    cpu.data[stack + 3] = pair.theirs->data[stack + 3] = static_cast<uint8_t>(back);
}

int run_stream(unsigned count, unsigned seed) {
    constexpr unsigned kWords = 0x2000;
    Pair pair;
    std::mt19937 random(seed);
    for (unsigned word = 0; word < kWords;) {
        const auto opcode = static_cast<uint16_t>(random());
        const bool far = (opcode & 0xFE0C) == 0x940C;
        const auto next = static_cast<uint16_t>(far ? random() % kWords : 0x410 + random() % 0x1B00);
        const Instruction in = decode(opcode, next, word);
        const int to = static_cast<int>(word) + in.jump;
        const bool leaves = in.run != ops::lds && in.run != ops::sts && (to < 0 || to >= int(kWords) - 4);
        if (!is_comparable(opcode, in) || leaves || in.run == ops::out || (far && (opcode & 0x01F1) != 0)) {
            continue;
        }
        pair.put_word(word++, opcode);
        if (is_two_words(opcode) && word < kWords) {
            pair.put_word(word++, next);
        }
    }
    randomise(pair, random, true);
    Cpu& cpu = pair.ours->cpu();
    avr_t* avr = pair.theirs;
    unsigned reports = 0, done = 0;
    for (; done < count && reports == 0; done++) {
        if (cpu.pc() >= kWords - 8) {
            const auto word = static_cast<unsigned>(random() % (kWords - 8));
            cpu.at = cpu.program + word;
            avr->pc = 2 * word;
        }
        // Interrupts stay off: entry is where libsimavr differs.
        cpu.interrupts_on = false;
        avr->sreg[S_I] = 0;
        cpu.asleep = false;
        if (reaches_memory(*cpu.at)) {
            lead_back(pair, random, kWords);
        }
        pair.ours->step();
        avr->pc = avr_run_one(avr);
        char what[32];
        std::snprintf(what, sizeof what, "instruction %u", done);
        const bool same = 2 * cpu.pc() == avr->pc && cpu.cycle == avr->cycle &&
                          (cpu.status() & 0x7F) == (their_status(avr) & 0x7F) &&
                          std::memcmp(cpu.data, avr->data, 32) == 0;
        if (!same || done % 1024 == 1023) {
            cpu.interrupts_on = false;
            avr->sreg[S_I] = 0;
            agree(pair, 0, what, &reports);
        }
    }
    std::printf("%u instructions in a row, %u disagree\n", done, reports);
    return reports == 0 ? 0 : 1;
}

void hear(avr_irq_t*, uint32_t value, void* text) {
    *static_cast<std::string*>(text) += static_cast<char>(value);
}

// What our program says, heard by somebody at the other end of its USB serial.
std::string run_ours(const Image& image, uint64_t cycles, std::vector<uint8_t>* eeprom) {
    const auto program = std::make_shared<Program>();
    for (const Block& block : image.flash) {
        program->write(block.address, block.bytes.data(), static_cast<uint32_t>(block.bytes.size()));
    }
    Tile tile(program, Fuses{}, Clock(), DataEnd{});
    std::string said;
    for (uint64_t end = 0; end <= cycles; end += 256) {
        tile.run_until(static_cast<double>(end), static_cast<double>(end));
        for (auto& heard = tile.host().received(); !heard.empty(); heard.pop_front()) {
            said += static_cast<char>(heard.front().value);
        }
    }
    *eeprom = tile.chip().eeprom().memory();
    return said + tile.chip().cpu().fault;
}

std::string run_theirs(const Image& image, uint64_t cycles, std::vector<uint8_t>* eeprom) {
    avr_t* avr = avr_make_mcu_by_name("atmega2560");
    avr_init(avr);
    avr->log = 0;
    avr->frequency = 16000000;
    for (const Block& block : image.flash) {
        std::memcpy(avr->flash + block.address, block.bytes.data(), block.bytes.size());
    }
    avr->codeend = avr->flashend;
    uint32_t flags = 0; // without them it prints what it hears, and sleeps while the program polls
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    std::string said;
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), hear, &said);
    while (avr->cycle < cycles && avr->state != cpu_Done && avr->state != cpu_Crashed) {
        avr_run(avr);
    }
    eeprom->assign(kEepromBytes, 0xFF);
    avr_eeprom_desc_t all = {eeprom->data(), 0, kEepromBytes};
    avr_ioctl(avr, AVR_IOCTL_EEPROM_GET, &all);
    return said;
}

int run_both(const char* path, uint64_t cycles) {
    const Image image = load_image(path);
    std::vector<uint8_t> eeprom;
    const std::string ours = run_ours(image, cycles, &eeprom), theirs = run_theirs(image, cycles, &eeprom);
    std::printf("ours: %s libsimavr: %s\n", ours.c_str(), theirs.c_str());
    return 0;
}

int run_whole(const char* path, uint64_t cycles) {
    const Image image = load_image(path);
    std::vector<uint8_t> our_eeprom, their_eeprom;
    const std::string ours = run_ours(image, cycles, &our_eeprom),
                      theirs = run_theirs(image, cycles, &their_eeprom);
    const bool same = ours == theirs && our_eeprom == their_eeprom;
    std::printf("%zu bytes said, %s\n", ours.size(), same ? "the same" : "not the same");
    if (!same) {
        std::printf("--- ours\n%s\n--- libsimavr\n%s\n", ours.c_str(), theirs.c_str());
    }
    return same ? 0 : 1;
}

int run_program(const char* path, unsigned long count) {
    Pair pair;
    for (const Block& block : load_image(path).flash) {
        pair.program->write(block.address, block.bytes.data(), static_cast<uint32_t>(block.bytes.size()));
        std::memcpy(pair.theirs->flash + block.address, block.bytes.data(), block.bytes.size());
    }
    avr_t* avr = pair.theirs;
    Cpu& cpu = pair.ours->cpu();
    std::memcpy(avr->data, cpu.data, kDataBytes);
    avr->pc = 0;
    avr->cycle = 0;
    avr->state = cpu_Running;
    unsigned reports = 0;
    unsigned long done = 0;
    for (; done < count; done++) {
        const uint64_t before = cpu.cycle;
        pair.ours->step();
        avr->pc = avr_run_one(avr);
        const bool same = 2 * cpu.pc() == avr->pc && cpu.cycle == avr->cycle &&
                          cpu.status() == their_status(avr) && std::memcmp(cpu.data, avr->data, 32) == 0;
        if (!same || done + 1 == count) {
            char what[64];
            std::snprintf(what, sizeof what, "instruction %lu, after cycle %llu", done,
                          static_cast<unsigned long long>(before));
            if (!agree(pair, 0, what, &reports)) {
                break;
            }
        }
    }
    std::printf("%lu instructions, %llu cycles, %u disagree\n", done,
                static_cast<unsigned long long>(cpu.cycle), reports);
    return reports == 0 ? 0 : 1;
}

} // namespace

int main(int argc, char** argv) {
    if (argc == 4 && std::strcmp(argv[1], "random") == 0) {
        return run_random(static_cast<unsigned>(std::atoi(argv[2])),
                          static_cast<unsigned>(std::atoi(argv[3])));
    }
    if (argc == 4 && std::strcmp(argv[1], "stream") == 0) {
        return run_stream(static_cast<unsigned>(std::atoi(argv[2])),
                          static_cast<unsigned>(std::atoi(argv[3])));
    }
    if (argc == 4 && std::strcmp(argv[1], "whole") == 0) {
        return run_whole(argv[2], std::strtoul(argv[3], nullptr, 10) * 1000000);
    }
    if (argc == 4 && std::strcmp(argv[1], "both") == 0) {
        return run_both(argv[2], std::strtoul(argv[3], nullptr, 10) * 1000000);
    }
    if (argc == 4 && std::strcmp(argv[1], "program") == 0) {
        return run_program(argv[2], std::strtoul(argv[3], nullptr, 10));
    }
    std::fprintf(
        stderr,
        "usage: differential random|stream COUNT SEED | program ELF COUNT | whole|both ELF MEGACYCLES\n");
    return 2;
}
