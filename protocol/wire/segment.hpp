#pragma once
// The data plane of a participant on the coupler's own host (capability "shm1"): a segment of
// shared memory that carries the frames of STATE one way and of FORCE the other. Same bytes, same
// state machine as on the socket; the socket stays for everything else.
//
// The coupler creates the segment before WELCOME, under a name made of the random session id and
// the participant's name, for its own user alone. The participant maps it and removes the name at
// once: from then on the memory lives as long as the two processes, however they end. Nothing that
// a message says is ever opened.
//
//     page 0      words of both directions (bell, number of the message, sizes of its frames)
//     block up    header and arrays of STATE, each array on a boundary of 64 bytes
//     block down  those of FORCE
//
// The blocks grow with the number of rows, by the coupler; both keep the segment open for that.
// Because the two ends speak in turns, a block is never written before it has been read.
//
// Waiting is by futex, never by spinning, in slices after which the caller looks at the socket's
// monitor. A message that goes by the socket rings the bell as well, so that who waits here wakes.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "wire/codec.hpp"

namespace undertow::wire {

inline constexpr const char* shared_memory_capability = "shm1";

/// Bytes that STATE and FORCE of so many rows need, their headers included.
std::uint64_t state_bytes(std::size_t rows);
std::uint64_t force_bytes(std::size_t rows);

class Segment {
 public:
    /// The coupler's end, for the participant `name`. nullptr when the system has no shared memory.
    static std::unique_ptr<Segment> create(std::uint64_t session, const std::string& name);
    /// The participant's end; removes the name. nullptr when there is no segment of that name, of
    /// this user, for this session: another host or container.
    static std::unique_ptr<Segment> open(std::uint64_t session, const std::string& name);
    /// The coupler, at its start: removes the names that dead couplers of this user left behind, both
    /// of whose ends were killed before the participant had mapped it. Returns how many.
    static int sweep();
    ~Segment();
    Segment(const Segment&) = delete;
    Segment& operator=(const Segment&) = delete;

    bool joined() const;  // the participant has mapped it

    /// Coupler: makes room for messages of these sizes [byte]. False when there is not that much
    /// memory; what was there stays usable.
    bool reserve(std::uint64_t up, std::uint64_t down);

    /// Writes a message for the other end and rings. False when the block is too small for it.
    bool write(const Frames& frames);
    /// Rings for a message that went by the socket.
    void ring();

    bool has_message() const;
    /// Decodes the message that came into `message`, whose buffers are reused; returns its size
    /// [byte]. Throws PeerError like decode(), and E_SHAPE when sizes pass the block.
    std::uint64_t read(Message& message);
    /// A message has gone by the socket since the last call: it may be on its way.
    bool heard_of_socket();
    /// What has gone by it so far has been read. Otherwise a bell heard late, after its message had come,
    /// lets the next turn look for 10 ms at a socket that stays silent.
    void forget_socket();

    /// The bell of what comes to this end. Read it before looking for messages, wait with it after.
    std::uint32_t bell() const;

    struct Ring {
        Segment* segment;
        std::uint32_t bell;
    };
    /// Sleeps until one of the bells differs from its value here, at most `seconds`. Returns at
    /// once when one already does. True when the time has passed.
    static bool wait(std::span<const Ring> rings, double seconds);

 private:
    struct Words;
    struct Direction;
    Segment(int descriptor, std::string name, bool coupler);
    bool map_words();
    bool map_blocks(std::uint64_t up, std::uint64_t down);
    void adopt();  // participant: follows the coupler's growth

    Direction& out() const;
    Direction& in() const;
    std::byte* out_block() const;
    std::byte* in_block() const;

    int descriptor_;
    std::string name_;  // while it exists in the system
    bool coupler_;
    Words* words_ = nullptr;
    std::byte* blocks_ = nullptr;
    std::uint64_t up_ = 0, down_ = 0;  // [byte] of the blocks, as mapped
    std::uint32_t layout_ = 0;
    std::uint32_t read_ = 0, written_ = 0, heard_ = 0;  // messages
    std::string header_;  // copied out of the segment before it is believed
};

}  // namespace undertow::wire
