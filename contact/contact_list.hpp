#pragma once
// The contacts of a step. One contact is a row of numbers (Contact); a list holds eight rows side
// by side in a pack, so that every kernel reads what it needs of eight contacts as whole registers.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "contact/facet.hpp"
#include "contact/lanes.hpp"

namespace undertow {
class Archive;
}

namespace undertow::contact {

/// One particle on one facet.
struct Contact {
    std::uint32_t particle;  // active row
    std::uint32_t facet;
    std::array<double, 4> weight;  // w_a of the facet's nodes at the contact point
    Vec point;                     // [m] contact point, sum_a w_a x_a
    Vec normal;                    // unit, from the surface to the wet side
    double depth;                  // [m] penetration d = l0 - signed distance, > 0; forces take off
                                   // what the particle was in at the start
    double closing;                // [m/s] d(depth)/dt
    Vec slip;                      // [m/s] tangential velocity of the particle against the surface
    // Filled by the force laws.
    double stiffness = 0;        // [N/m]
    double normal_force = 0;     // [N] >= 0
    double damping_force = 0;    // [N] part of normal_force that is not stiffness * depth
    Vec friction = Vec::Zero();  // [N] on the particle
    Vec force = Vec::Zero();     // [N] on the particle, normal and friction
};

/// Eight contacts; fields as in Contact, or what they follow from: memory is what contact costs.
struct alignas(64) ContactPack {
    LaneRows particle, facet;
    LaneRows node[4];  // rows of the facet's nodes
    Lanes weight[4];
    Three<Lanes> point, normal;
    Lanes depth, closing;
    Three<Lanes> slip;
    Lanes stiffness, normal_force, damping_force;
    Lanes drag;  // [N s/m] friction = -drag slip
    Three<Lanes> friction() const { return -drag * slip; }
    Three<Lanes> force() const { return normal_force * normal + friction(); }
};

class ContactList;
/// Asks for pack p, if there is room for one. g++ leaves out calls of a function that only fetches,
/// unless it is inlined.
[[gnu::always_inline]] inline void fetch_pack(const ContactList& contacts, std::size_t p);

/// Lanes beyond the last contact repeat it, so that kernels may compute them; sums leave them out.
class ContactList {
 public:
    ContactList() = default;
    /// From rows; the nodes of each facet are taken from `quad`, (F, 4).
    ContactList(const std::vector<Contact>& rows, const std::int32_t* quad);

    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    std::size_t packs() const { return (size_ + lane_count - 1) / lane_count; }
    ContactPack& pack(std::size_t p) { return pack_[p]; }
    const ContactPack& pack(std::size_t p) const { return pack_[p]; }
    /// How many lanes of a pack are contacts.
    int lanes(std::size_t p) const {
        return int(std::min<std::size_t>(lane_count, size_ - p * lane_count));
    }
    std::uint32_t particle(std::size_t c) const {
        return std::uint32_t(pack_[c / lane_count].particle[c % lane_count]);
    }

    /// Packs that there is memory for.
    std::size_t room() const { return pack_.size(); }
    void clear() { size_ = 0; }
    void resize(std::size_t size);
    /// Adds the first `count` lanes of a pack.
    void append(const ContactPack& pack, int count);
    /// Contact `c` becomes contact `from_c` of another list.
    void copy(std::size_t c, const ContactList& from, std::size_t from_c);
    void fill_lanes_beyond();
    void swap(ContactList& other) noexcept {
        pack_.swap(other.pack_);
        std::swap(size_, other.size_);
    }

    /// One contact as a row; a copy.
    Contact operator[](std::size_t c) const;
    std::vector<Contact> rows() const;
    void archive(Archive& a);

    class Iterator {
     public:
        Iterator(const ContactList& list, std::size_t c) : list_(&list), c_(c) {}
        Contact operator*() const { return (*list_)[c_]; }
        Iterator& operator++() {
            ++c_;
            return *this;
        }
        bool operator!=(const Iterator& other) const { return c_ != other.c_; }

     private:
        const ContactList* list_;
        std::size_t c_;
    };
    Iterator begin() const { return {*this, 0}; }
    Iterator end() const { return {*this, size_}; }

 private:
    std::vector<ContactPack> pack_;
    std::size_t size_ = 0;
};

void fetch_pack(const ContactList& contacts, std::size_t p) {
    if (p >= contacts.room()) return;
    const char* at = reinterpret_cast<const char*>(&contacts.pack(p));
#pragma GCC unroll 32
    for (std::size_t line = 0; line < sizeof(ContactPack); line += 64)
        __builtin_prefetch(at + line);
}

}  // namespace undertow::contact
