#include "base_array.h"

namespace tilenca {
namespace fuzz {

namespace {

constexpr uint16_t kReti = 0x9518, kSei = 0x9478, kNop = 0;
constexpr unsigned kVectorWords = 2 * 57;

struct Write {
    uint16_t address;
    uint8_t value;
};

// Numbers of data memory, in the order of the data sheet's register summary.
constexpr Write kSetUp[] = {
    {0x21, 0xFF},  {0x24, 0xF0},  {0x101, 0xFF}, {0x107, 0x0F}, {0x10A, 0xFF}, // DDRA, DDRB, DDRH, DDRK, DDRL
    {0x68, 0x07},  {0x6B, 0xFF},  {0x6D, 0xFF},  {0x3D, 0xFF},                 // pin interrupts
    {0x44, 0xA3},  {0x45, 0x02},  {0x47, 0x40},  {0x6E, 0x03},                 // timer 0
    {0x80, 0xAA},  {0x81, 0xDA},  {0x88, 0x90},  {0x6F, 0x27},                 // timer 1, capture
    {0xB0, 0x63},  {0xB1, 0x09},  {0xB3, 0x55},  {0x70, 0x07},                 // timer 2
    {0x90, 0x40},  {0x91, 0x1A},  {0x96, 0x01},  {0x98, 0x80},                 // timer 3
    {0xA1, 0x06},  {0x121, 0x0F}, {0x71, 0x07},  {0x73, 0x07},                 // timers 4, 5
    {0xC1, 0xD8},  {0xC2, 0x06},  {0xC4, 0x08},                                // USART 0
    {0xC9, 0xD8},  {0xCA, 0x36},  {0xCC, 0x10},                                // USART 1
    {0xD1, 0xD8},  {0xD2, 0x0E},  {0xD4, 0x03},                                // USART 2
    {0x131, 0xD8}, {0x132, 0x06}, {0x134, 0x19},                               // USART 3
    {0x7C, 0x41},  {0x7A, 0xEF},                                               // ADC, free running
    {0x50, 0x0B},  {0x4C, 0xD1},  {0xB8, 0x08},  {0xBC, 0xC5},                 // comparator, SPI, TWI
    {0x60, 0x18},  {0x60, 0x46},                                               // watchdog
    {0x41, 0x07},  {0x40, 0x5A},  {0x3F, 0x0C},  {0x3F, 0x0A},                 // EEPROM
};
constexpr Write kOverAndOver[] = {{0xC6, 0x53}, {0xCE, 0xAA}, {0xD6, 0x0F}, {0x136, 0xF0}, {0x4E, 0x3C}};

void put(std::vector<uint16_t>& words, const Write& write) {
    words.push_back(
        static_cast<uint16_t>(0xE000 | (write.value & 0xF0) << 4 | (write.value & 0x0F))); // LDI r16
    words.push_back(0x9300);                                                               // STS
    words.push_back(write.address);
}

void seconds(Array& array, double s) {
    array.run_for(s * kTicksPerSecond);
}

} // namespace

Image base_image() {
    std::vector<uint16_t> words(kVectorWords, kReti);
    words[0] = 0x940C; // JMP
    words[1] = kVectorWords;
    for (const Write& write : kSetUp) {
        put(words, write);
    }
    words.push_back(kSei);
    const size_t loop = words.size();
    for (const Write& write : kOverAndOver) {
        put(words, write);
        words.insert(words.end(), 20, kNop);
    }
    words.push_back(0x940C);
    words.push_back(static_cast<uint16_t>(loop));
    Image image;
    image.flash.push_back({0, {}});
    for (const uint16_t word : words) {
        image.flash[0].bytes.push_back(static_cast<uint8_t>(word));
        image.flash[0].bytes.push_back(static_cast<uint8_t>(word >> 8));
    }
    return image;
}

std::unique_ptr<Array> base_array(unsigned variant) {
    static const Image image = base_image();
    auto array = std::make_unique<Array>(image, avr::Fuses(),
                                         std::vector<Clock>{Clock(2e-3), Clock(-1e-3, 1e-4, 3000)});
    if (variant == 3) {
        array->set_hardware({7, true, false, false, 0.05}, avr::Drive::Middle);
    }
    array->link({0, 0}, {1, 2});
    array->link({0, 1}, {1, 3});
    array->link({0, 2}, {1, 0});
    array->wire_from({0, 1})->set_fault({0.3, 0.2, 100, 0}, 5);
    seconds(*array, 0.5e-3);
    for (const uint8_t byte : {'a', '\0', 'z'}) {
        array->tile(0).host().send(byte);
    }
    if (variant == 1) {
        array->tile(0).press_button(true);
        array->set_power(1, false);
    }
    if (variant == 2) {
        array->set_connected({0, 0}, false);
        array->tile(0).clock().set_skew(0.01, array->now());
    }
    seconds(*array, 0.4e-3 * (variant + 1));
    return array;
}

} // namespace fuzz
} // namespace tilenca
