#include "translate/frame.h"

#include "avr/cpu.h"
#include "effects_text.h"

#include <cctype>
#include <cstddef>

namespace tilenca::translate {

namespace {

constexpr unsigned kTextVersion = 5; // one more with every change of what is emitted

// What comes after the places of the core's members and before the functions.
constexpr const char* kPrelude = R"text(
using namespace tilenca::avr::effects;

struct Cpu;
struct Instruction;
using Handler = void (*)(Cpu*, const Instruction*, uint64_t, uint32_t, uint32_t, uint32_t);
struct Instruction {
    Handler run;
    uint32_t operands[2];
};

#define STATE Cpu *cpu, const Instruction *at, uint64_t cycle, uint32_t carry, uint32_t zero, uint32_t nvh
#define PASSED cpu, at, cycle, carry, zero, nvh
#define MEMBER(type, place) (*reinterpret_cast<type*>(reinterpret_cast<char*>(cpu) + (place)))
#define DATA(address) (reinterpret_cast<uint8_t*>(cpu)[address])
// Byte for byte: the host would have to wait for bytes that were stored just before, one by one.
#define STORED(address) uint32_t{reinterpret_cast<volatile uint8_t*>(cpu)[address]}
#define LIMIT MEMBER(uint64_t, AT_LIMIT)
#define HELD_UNTIL MEMBER(uint64_t, AT_HELD_UNTIL)
#define REQUESTS MEMBER(const uint64_t, AT_REQUESTS)
#define TRANSFER MEMBER(bool, AT_TRANSFER)
#define INTERRUPTS MEMBER(bool, AT_INTERRUPTS)
#define SPECIAL(address) MEMBER(const uint8_t, AT_SPECIAL + (address))
#define FLASH MEMBER(const uint8_t* const, AT_FLASH)
#define FLASH_LIMIT MEMBER(const uint32_t, AT_FLASH_LIMIT)
#define PROGRAM MEMBER(const Instruction* const, AT_PROGRAM)
#define IS_SRAM(address) ((address) - 0x200u < 0x2000u)
#define IS_PLAIN_PUSH(top, count)                                                          \
    (static_cast<uint16_t>((top) - (count) + 1u - MEMBER(const uint16_t, AT_STACK_LOW)) + (count) <= \
     MEMBER(const uint16_t, AT_STACK_ROOM))
#define RARE(condition) __builtin_expect(condition, 0)

namespace {

// A register that is a byte of a longer number of so many bytes.
template <unsigned shift, unsigned bytes>
struct Byte {
    uint32_t& whole;
    operator uint32_t() const { return whole >> shift & 0xFF; }
    const Byte& operator=(uint32_t value) const {
        whole = (whole & ~(0xFFu << shift)) | value << shift;
        return *this;
    }
};
TILENCA_EFFECT uint32_t word(uint32_t low, uint32_t high) {
    return high << 8 | low;
}
template <unsigned bytes>
TILENCA_EFFECT uint32_t word(const Byte<0, bytes>& low, const Byte<8, bytes>&) {
    return low.whole & 0xFFFF;
}
template <class Low, class High>
TILENCA_EFFECT void put(Low& low, High& high, uint32_t word) {
    low = word & 0xFF;
    high = word >> 8;
}
TILENCA_EFFECT void put(const Byte<0, 2>& low, const Byte<8, 2>&, uint32_t word) {
    low.whole = word;
}

Handler handlers[COUNT], leave;

[[gnu::always_inline]] inline void next(STATE) {
    if (RARE(cycle >= LIMIT)) {
        return leave(PASSED);
    }
    return at->run(PASSED);
}
// Cold, so that the compiler puts the way there out of the way.
[[gnu::cold, gnu::noinline]] void interpret(STATE) {
    return at->run(PASSED);
}
template <unsigned block>
[[gnu::cold, gnu::noinline]] void interpret_first(STATE) {
    if (cycle >= LIMIT) {
        return leave(PASSED);
    }
    return handlers[block](PASSED);
}

)text";

std::string define(const char* name, size_t place) {
    return std::string("#define ") + name + " " + std::to_string(place) + "\n";
}

std::string places() {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Winvalid-offsetof"
    return define("AT_LIMIT", offsetof(avr::Cpu, limit)) +
           define("AT_HELD_UNTIL", offsetof(avr::Cpu, held_until)) +
           define("AT_REQUESTS", offsetof(avr::Cpu, requests)) +
           define("AT_TRANSFER", offsetof(avr::Cpu, transfer)) +
           define("AT_INTERRUPTS", offsetof(avr::Cpu, interrupts_on)) +
           define("AT_SPECIAL", offsetof(avr::Cpu, special)) + define("AT_FLASH", offsetof(avr::Cpu, flash)) +
           define("AT_FLASH_LIMIT", offsetof(avr::Cpu, flash_limit)) +
           define("AT_PROGRAM", offsetof(avr::Cpu, program)) +
           define("AT_STACK_LOW", offsetof(avr::Cpu, stack_low)) +
           define("AT_STACK_ROOM", offsetof(avr::Cpu, stack_room));
#pragma GCC diagnostic pop
}

} // namespace

std::string layout() {
    std::string shown = std::to_string(kTextVersion);
    for (const char c : places()) { // the numbers tell it all
        if (c == '\n' || std::isdigit(static_cast<unsigned char>(c)) != 0) {
            shown += c == '\n' ? ' ' : c;
        }
    }
    return shown;
}

std::string head_of(size_t blocks) {
    return std::string("// Translated from an image's instructions; not to be read.\n") + kEffectsText +
           places() + define("COUNT", blocks) + "#define LAYOUT \"" + layout() + "\"\n" + kPrelude;
}

std::string tail_of(const avr::Program& program, const std::vector<Block>& blocks,
                    const std::vector<std::string>& names) {
    std::string begins, functions, words, code;
    size_t count = 0;
    for (size_t i = 0; i < blocks.size(); i++) {
        begins += std::to_string(blocks[i].words[0]) + ",";
        functions += names[i] + ",";
        for (const uint32_t word : blocks[i].words) {
            for (uint32_t one = word; one < word_after(program, word); one++, count++) {
                words += std::to_string(one) + ",";
                code += std::to_string(program.word(one)) + ",";
            }
        }
    }
    return "const uint32_t begins[] = {" + begins + "};\nconst Handler functions[] = {" + functions +
           "};\nconst uint32_t code_words[] = {" + words + "};\nconst uint16_t code[] = {" + code +
           "};\n\n} // namespace\n\nextern \"C\" const struct {\n    const char* layout;\n    uint32_t "
           "count;\n"
           "    const uint32_t* begins;\n    const Handler* functions;\n    Handler* handlers;\n    Handler* "
           "leave;\n"
           "    uint32_t code_count;\n    const uint32_t* code_words;\n    const uint16_t* code;\n"
           "} tilenca_blocks __attribute__((visibility(\"default\"))) = {LAYOUT, COUNT, begins, functions, "
           "handlers, "
           "&leave, " +
           std::to_string(count) + ", code_words, code};\n";
}

} // namespace tilenca::translate
