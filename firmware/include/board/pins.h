// The only pin map of the tile, for the authors' board (Project Cube PCB v1.0, docs/HARDWARE.md).
//
// It is only data, so that the emulator's tile is wired by the same table. Pins have AVR port letter and bit;
// the Arduino numbers are in the comments.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

struct Pin {
    char port;
    uint8_t bit;
};

// HIGH lights a segment: a b c d e f g dp (Arduino 7 6 5 13 12 9 8 4).
constexpr Pin kSegments[8] = {{'H', 4}, {'H', 3}, {'E', 3}, {'B', 7}, {'B', 6}, {'H', 6}, {'H', 5}, {'G', 5}};

// PWM, higher duty is brighter: OC1A (Arduino 11), OC2A (10), OC3C (3).
constexpr Pin kRed = {'B', 5};
constexpr Pin kGreen = {'B', 4};
constexpr Pin kBlue = {'E', 5};

// HIGH lights: A8 A9 A10 A11, one per side in the order N E S W.
constexpr Pin kDebugLeds[4] = {{'K', 0}, {'K', 1}, {'K', 2}, {'K', 3}};

// 10 kohm pull-up, pressed = LOW: A0.
constexpr Pin kButton = {'F', 0};

// The SOUTH link's software UART: A14 receives (PCINT22), A15 sends.
constexpr Pin kSouthRx = {'K', 6};
constexpr Pin kSouthTx = {'K', 7};

// The USART of each side in the order N E S W; SOUTH has none (0 is the host's USB).
constexpr uint8_t kSideUsart[4] = {2, 1, 0, 3};
constexpr uint8_t kHostUsart = 0;

// The receiving pin of each side, which floats while there is no neighbour: RXD2, RXD1, A14, RXD3.
constexpr Pin kSideRx[4] = {{'H', 0}, {'D', 2}, kSouthRx, {'J', 0}};

// The sending pin of each side: TXD2, TXD1, A15, TXD3.
constexpr Pin kSideTx[4] = {{'H', 1}, {'D', 3}, kSouthTx, {'J', 1}};

} // namespace board
} // namespace tilenca
