#include "wire/segment.hpp"

#include <fcntl.h>
#include <linux/futex.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <new>

#include "wire/errors.hpp"

namespace undertow::wire {

namespace {

constexpr std::uint64_t page = 4096;        // [byte] of the words
constexpr std::uint64_t line = 64;          // [byte] arrays begin on cache lines
constexpr std::uint64_t for_header = page;  // [byte]; STATE has some 130, its limiter a sentence
constexpr double room_to_grow = 1.5;        // active particles come and go
constexpr std::array<char, 8> magic{'U', 'T', 'O', 'W', 's', 'h', 'm', '1'};

constexpr std::uint64_t aligned(std::uint64_t bytes) {
    return (bytes + line - 1) / line * line;
}

std::uint64_t to_pages(double bytes) {
    return std::uint64_t(std::ceil(bytes / double(page))) * page;
}

std::string name_of_segment(std::uint64_t session, const std::string& participant) {
    char text[40];
    std::snprintf(text, sizeof text, "/undertow-%016llx-",
                  static_cast<unsigned long long>(session));
    return text + participant;  // letters, digits, _ - . only: HELLO has been checked
}

timespec after(double seconds, clockid_t clock) {
    timespec at{};
    if (clock >= 0) clock_gettime(clock, &at);
    at.tv_sec += time_t(seconds);
    at.tv_nsec += long((seconds - std::floor(seconds)) * 1e9);
    if (at.tv_nsec >= 1000000000) at.tv_sec += 1, at.tv_nsec -= 1000000000;
    return at;
}

// Of linux/futex.h since 5.16; older headers lack them.
struct FutexWait {
    std::uint64_t value, address;
    std::uint32_t flags, reserved;
};
constexpr long futex_waitv_number = 449;
constexpr std::uint32_t futex_of_32_bits = 2;

}  // namespace

struct Segment::Direction {
    alignas(line) std::atomic<std::uint32_t> bell;  // futex word: rises with every message
    std::atomic<std::uint32_t> message;             // how many have been written to the block
    std::atomic<std::uint32_t> by_socket;           // how many went by the socket
    std::uint32_t header_size, n_arrays;
    std::uint64_t size[max_arrays];  // [byte]
};

struct Segment::Words {
    std::array<char, 8> magic;
    std::uint64_t session;
    std::atomic<std::uint32_t> joined;
    std::atomic<std::uint32_t> layout;  // rises when the blocks grow
    std::uint64_t up_bytes, down_bytes;
    Direction up, down;
};

std::uint64_t state_bytes(std::size_t rows) {
    return for_header + 2 * aligned(rows * 3 * sizeof(double));
}

std::uint64_t force_bytes(std::size_t rows) {
    return for_header + aligned(rows * 3 * sizeof(double));
}

Segment::Segment(int descriptor, std::string name, bool coupler)
    : descriptor_(descriptor), name_(std::move(name)), coupler_(coupler) {
    static_assert(sizeof(Words) <= page && std::atomic<std::uint32_t>::is_always_lock_free);
    header_.reserve(for_header);
}

Segment::~Segment() {
    if (blocks_) munmap(blocks_, up_ + down_);
    if (words_) munmap(words_, page);
    if (!name_.empty()) shm_unlink(name_.c_str());
    close(descriptor_);
}

bool Segment::map_words() {
    void* memory = mmap(nullptr, page, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, 0);
    if (memory == MAP_FAILED) return false;
    words_ = static_cast<Words*>(memory);
    return true;
}

bool Segment::map_blocks(std::uint64_t up, std::uint64_t down) {
    void* memory = mmap(nullptr, up + down, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, page);
    if (memory == MAP_FAILED) return false;
    if (blocks_) munmap(blocks_, up_ + down_);
    blocks_ = static_cast<std::byte*>(memory);
    up_ = up, down_ = down;
    return true;
}

std::unique_ptr<Segment> Segment::create(std::uint64_t session, const std::string& participant) {
    const std::string name = name_of_segment(session, participant);
    const int descriptor = shm_open(name.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
    if (descriptor < 0) return nullptr;
    std::unique_ptr<Segment> segment(new Segment(descriptor, name, true));
    flock(descriptor, LOCK_EX | LOCK_NB);  // goes with the process: see sweep()
    // Reserved, not only named: where the memory does not suffice, a later write would be a SIGBUS.
    if (posix_fallocate(descriptor, 0, page) != 0 || !segment->map_words()) return nullptr;
    Words* words = new (segment->words_) Words{};
    words->session = session;
    words->magic = magic;
    return segment;
}

namespace {

constexpr double young = 10;  // [s] a coupler that has just made its segment may not have locked it

/// A segment of ours that no living coupler holds.
bool is_left_behind(int descriptor) {
    struct stat status {};
    if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode) || status.st_uid != geteuid() ||
        (status.st_mode & 077) != 0 || std::uint64_t(status.st_size) > page)
        return false;
    if (std::difftime(std::time(nullptr), status.st_mtime) < young) return false;
    return flock(descriptor, LOCK_EX | LOCK_NB) == 0;
}

}  // namespace

int Segment::sweep() {
    int removed = 0;
    std::error_code trouble;  // no such folder: no shared memory, nothing to sweep
    for (const auto& entry : std::filesystem::directory_iterator("/dev/shm", trouble)) {
        const std::string name = entry.path().filename();
        if (!name.starts_with("undertow-")) continue;
        const int descriptor = shm_open(name.c_str(), O_RDWR | O_NOFOLLOW, 0);
        if (descriptor < 0) continue;
        if (is_left_behind(descriptor) && shm_unlink(name.c_str()) == 0) ++removed;
        close(descriptor);
    }
    return removed;
}

std::unique_ptr<Segment> Segment::open(std::uint64_t session, const std::string& participant) {
    const std::string name = name_of_segment(session, participant);
    const int descriptor = shm_open(name.c_str(), O_RDWR | O_NOFOLLOW, 0);
    if (descriptor < 0) return nullptr;
    std::unique_ptr<Segment> segment(new Segment(descriptor, name, false));
    struct stat status {};
    if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode) || status.st_uid != geteuid() ||
        (status.st_mode & 077) != 0 || std::uint64_t(status.st_size) != page) {
        segment->name_.clear();  // not ours: not ours to remove
        return nullptr;
    }
    if (!segment->map_words()) return nullptr;
    shm_unlink(name.c_str());
    segment->name_.clear();
    if (segment->words_->magic != magic || segment->words_->session != session) return nullptr;
    segment->words_->joined.store(1);
    return segment;
}

bool Segment::joined() const {
    return words_->joined.load() != 0;
}

bool Segment::reserve(std::uint64_t up, std::uint64_t down) {
    if (up <= up_ && down <= down_) return true;
    const std::uint64_t new_up = up <= up_ ? up_ : to_pages(room_to_grow * double(up));
    const std::uint64_t new_down = down <= down_ ? down_ : to_pages(room_to_grow * double(down));
    if (posix_fallocate(descriptor_, 0, off_t(page + new_up + new_down)) != 0) return false;
    if (!map_blocks(new_up, new_down)) return false;
    words_->up_bytes = up_;
    words_->down_bytes = down_;
    words_->layout.store(++layout_, std::memory_order_release);
    return true;
}

void Segment::adopt() {
    const std::uint32_t layout = words_->layout.load(std::memory_order_acquire);
    if (coupler_ || layout == layout_) return;
    const std::uint64_t up = words_->up_bytes, down = words_->down_bytes;
    struct stat status {};
    const std::uint64_t largest =
        fstat(descriptor_, &status) == 0 ? std::uint64_t(status.st_size) : 0;
    if (up > largest || down > largest || page + up + down > largest || !map_blocks(up, down)) {
        throw PeerError("E_SHAPE", "the shared memory is smaller than the coupler says (" +
                                       std::to_string(up) + " + " + std::to_string(down) +
                                       " bytes in " + std::to_string(largest) + ")");
    }
    layout_ = layout;
}

Segment::Direction& Segment::out() const {
    return coupler_ ? words_->down : words_->up;
}
Segment::Direction& Segment::in() const {
    return coupler_ ? words_->up : words_->down;
}
std::byte* Segment::out_block() const {
    return blocks_ + (coupler_ ? up_ : 0);
}
std::byte* Segment::in_block() const {
    return blocks_ + (coupler_ ? 0 : up_);
}

bool Segment::write(const Frames& frames) {
    adopt();
    const std::uint64_t capacity = coupler_ ? down_ : up_;
    std::uint64_t bytes = aligned(frames.header.size());
    for (std::size_t i = 0; i < frames.n_arrays; ++i) bytes += aligned(frames.arrays[i].size());
    if (bytes > capacity) return false;

    Direction& direction = out();
    std::byte* place = out_block();
    std::memcpy(place, frames.header.data(), frames.header.size());
    place += aligned(frames.header.size());
    for (std::size_t i = 0; i < frames.n_arrays; ++i) {
        const Bytes data = frames.arrays[i];
        if (!data.empty()) std::memcpy(place, data.data(), data.size());
        place += aligned(data.size());
        direction.size[i] = data.size();
    }
    direction.header_size = std::uint32_t(frames.header.size());
    direction.n_arrays = std::uint32_t(frames.n_arrays);
    direction.message.store(++written_, std::memory_order_release);
    direction.bell.fetch_add(1);
    syscall(SYS_futex, &direction.bell, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0);
    return true;
}

void Segment::ring() {
    Direction& direction = out();
    direction.by_socket.fetch_add(1);
    direction.bell.fetch_add(1);
    syscall(SYS_futex, &direction.bell, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0);
}

bool Segment::has_message() const {
    return in().message.load(std::memory_order_acquire) != read_;
}

bool Segment::heard_of_socket() {
    const std::uint32_t count = in().by_socket.load();
    return std::exchange(heard_, count) != count;
}

void Segment::forget_socket() {
    heard_ = in().by_socket.load();
}

std::uint64_t Segment::read(Message& message) {
    adopt();
    Direction& direction = in();
    read_ = direction.message.load(std::memory_order_acquire);
    // Each size is read once, and judged as it was read: the other end may write at any time.
    const std::uint64_t capacity = coupler_ ? up_ : down_;
    const std::uint64_t header_size = direction.header_size;
    const std::size_t n_arrays = direction.n_arrays;
    const auto refuse = [](const std::string& what) {
        throw PeerError("E_SHAPE", "shared memory: " + what);
    };
    if (header_size > max_header || header_size > capacity)
        refuse("a header of " + std::to_string(header_size) + " bytes does not fit its block");
    if (n_arrays > max_arrays) refuse(std::to_string(n_arrays) + " arrays came; at most 16 may");
    header_.assign(reinterpret_cast<const char*>(in_block()), header_size);
    std::array<Bytes, max_arrays> arrays;
    std::uint64_t place = aligned(header_size), bytes = header_size;
    for (std::size_t i = 0; i < n_arrays; ++i) {
        const std::uint64_t size = direction.size[i];
        if (place > capacity || size > capacity - place)
            refuse("an array of " + std::to_string(size) + " bytes does not fit its block");
        arrays[i] = {in_block() + place, size};
        place += aligned(size);
        bytes += size;
    }
    decode(std::as_bytes(std::span(header_)), std::span(arrays.data(), n_arrays), message);
    return bytes;
}

std::uint32_t Segment::bell() const {
    return in().bell.load(std::memory_order_acquire);
}

bool Segment::wait(std::span<const Ring> rings, double seconds) {
    constexpr std::size_t most = 16;
    if (rings.size() > 1 && rings.size() <= most) {
        std::array<FutexWait, most> waits{};
        for (std::size_t i = 0; i < rings.size(); ++i) {
            waits[i] = {rings[i].bell,
                        reinterpret_cast<std::uint64_t>(&rings[i].segment->in().bell),
                        futex_of_32_bits, 0};
        }
        const timespec until = after(seconds, CLOCK_MONOTONIC);
        const long woken = syscall(futex_waitv_number, waits.data(), unsigned(rings.size()), 0u,
                                   &until, CLOCK_MONOTONIC);
        if (woken >= 0 || errno != ENOSYS) return woken < 0 && errno == ETIMEDOUT;
        // Linux before 5.16: wait for the first; all have to come before the coupler can go on.
    }
    const timespec span = after(seconds, -1);
    const long woken = syscall(SYS_futex, &rings[0].segment->in().bell, FUTEX_WAIT, rings[0].bell,
                               &span, nullptr, 0);
    return woken < 0 && errno == ETIMEDOUT;
}

}  // namespace undertow::wire
