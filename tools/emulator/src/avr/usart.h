// One of the four USARTs, asynchronous mode: double-buffered transmitter, receiver with two bytes of FIFO.
//
// The transmitter announces the edges of a whole frame when it starts; the receiver samples its wire as the
// chip does, but looks at all samples at once when the stop bit has been decided.
#pragma once

#include "avr/frame_reader.h"
#include "avr/gpio.h"

namespace tilenca::avr {

class Usart final : public Peripheral {
  public:
    Usart(const Core& core, Gpio& gpio, unsigned number);

    std::vector<uint16_t> registers() const override;
    uint8_t read(uint16_t address, uint64_t cycle) override;
    void write(uint16_t address, uint8_t value, uint64_t cycle) override;
    void on_event(Slot slot, uint64_t cycle) override;
    std::vector<uint8_t> vectors() const override;
    void interrupt_taken(uint8_t vector) override;
    void reset(uint64_t cycle) override;
    void state(Archive& archive) override;

    PinId receive_pin() const { return receive_pin_; }
    PinId transmit_pin() const { return transmit_pin_; }
    // Clock cycles one bit takes; 0 while receiver and transmitter are off.
    uint32_t bit_cycles() const;
    // To be called after edges were pushed on the receiver's wire.
    void line_changed();
    // Edges of the wire before this cycle matter no more.
    uint64_t needs_line_from(uint64_t now) const;

  private:
    enum class Receiver : uint8_t { Off, Idle, Starting, Receiving };
    friend constexpr Receiver last_of(Receiver) { return Receiver::Receiving; }

    struct Received {
        uint16_t data = 0;
        bool framing_error = false;
        bool parity_error = false;
        bool overrun = false; // bytes were lost between the one before and this one
        void state(Archive& archive) { archive(data, framing_error, parity_error, overrun); }
    };

    void clock_stops(uint64_t cycle) override;
    void clock_starts(uint64_t cycle, uint64_t stood) override;
    uint16_t a() const { return base_; }
    uint16_t b() const { return static_cast<uint16_t>(base_ + 1); }
    uint16_t c() const { return static_cast<uint16_t>(base_ + 2); }
    uint32_t sample_cycles() const;
    unsigned samples_per_bit() const;
    FrameFormat format() const;
    uint64_t next_sample(uint64_t cycle) const;
    void write_control(uint8_t value, uint64_t cycle);
    void send(uint8_t data, uint64_t cycle);
    void start_frame(uint16_t data, uint64_t cycle);
    void frame_sent(uint64_t cycle);
    void await_start(uint64_t from);
    void start_bit_seen();
    void frame_received(uint64_t cycle);
    uint8_t take_received();
    uint8_t status() const;
    void update_requests();

    Gpio& gpio_;
    uint16_t base_;
    uint8_t first_vector_;
    Slot receive_slot_, transmit_slot_;
    PinId receive_pin_, transmit_pin_;
    uint64_t baud_origin_ = 0; // the baud generator counts from here

    bool sending_ = false, sent_flag_ = false, buffer_full_ = false;
    uint16_t buffer_ = 0;

    Receiver receiver_ = Receiver::Off;
    Sampling sampling_{0, 1, 16};
    FrameFormat receive_format_;
    std::array<Received, 3> fifo_; // two bytes, and a third that waits in the shift register
    unsigned waiting_ = 0;
    bool lost_ = false;
    uint8_t last_data_ = 0;
    bool start_is_noise_ = false; // of the frame that is awaited
};

} // namespace tilenca::avr
