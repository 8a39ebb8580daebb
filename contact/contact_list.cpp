#include "contact/contact_list.hpp"

#include <cstring>

namespace undertow::contact {

namespace {

// A pack is 6 x 8 rows of 4 bytes, then registers of eight doubles.
constexpr int row_fields = 6;
constexpr std::size_t number_fields =
    (sizeof(ContactPack) - row_fields * sizeof(LaneRows)) / sizeof(Lanes);
static_assert(sizeof(ContactPack) == row_fields * sizeof(LaneRows) + number_fields * sizeof(Lanes));

/// One lane of `to` becomes one of `from`.
void copy_lane(ContactPack& to, int lane, const ContactPack& from, int from_lane) {
    auto* rows = reinterpret_cast<LaneRows*>(&to);
    const auto* from_rows = reinterpret_cast<const LaneRows*>(&from);
    for (int f = 0; f < row_fields; ++f) rows[f][lane] = from_rows[f][from_lane];
    auto* numbers = reinterpret_cast<Lanes*>(rows + row_fields);
    const auto* from_numbers = reinterpret_cast<const Lanes*>(from_rows + row_fields);
    for (std::size_t f = 0; f < number_fields; ++f) numbers[f][lane] = from_numbers[f][from_lane];
}

void put(Three<Lanes>& at, int lane, const Vec& v) {
    at.x[lane] = v[0], at.y[lane] = v[1], at.z[lane] = v[2];
}
Vec take(const Three<Lanes>& from, int lane) {
    return {from.x[lane], from.y[lane], from.z[lane]};
}

}  // namespace

ContactList::ContactList(const std::vector<Contact>& rows, const std::int32_t* quad) {
    resize(rows.size());
    for (std::size_t c = 0; c < rows.size(); ++c) {
        const Contact& row = rows[c];
        ContactPack& p = pack_[c / lane_count];
        const int lane = int(c % lane_count);
        p.particle[lane] = std::int32_t(row.particle);
        p.facet[lane] = std::int32_t(row.facet);
        for (int a = 0; a < 4; ++a) {
            p.node[a][lane] = quad[4 * std::size_t(row.facet) + a];
            p.weight[a][lane] = row.weight[a];
        }
        put(p.point, lane, row.point);
        put(p.normal, lane, row.normal);
        p.depth[lane] = row.depth;
        p.closing[lane] = row.closing;
        put(p.slip, lane, row.slip);
        p.stiffness[lane] = row.stiffness;
        p.normal_force[lane] = row.normal_force;
        p.damping_force[lane] = row.damping_force;
        const double slip2 = row.slip.squaredNorm();
        p.drag[lane] = slip2 > 0 ? -row.friction.dot(row.slip) / slip2 : 0;
    }
    fill_lanes_beyond();
}

Contact ContactList::operator[](std::size_t c) const {
    const ContactPack& p = pack_[c / lane_count];
    const int lane = int(c % lane_count);
    Contact row;
    row.particle = std::uint32_t(p.particle[lane]);
    row.facet = std::uint32_t(p.facet[lane]);
    for (int a = 0; a < 4; ++a) row.weight[a] = p.weight[a][lane];
    row.point = take(p.point, lane);
    row.normal = take(p.normal, lane);
    row.depth = p.depth[lane];
    row.closing = p.closing[lane];
    row.slip = take(p.slip, lane);
    row.stiffness = p.stiffness[lane];
    row.normal_force = p.normal_force[lane];
    row.damping_force = p.damping_force[lane];
    row.friction = -p.drag[lane] * row.slip;
    row.force = row.normal_force * row.normal + row.friction;
    return row;
}

std::vector<Contact> ContactList::rows() const {
    std::vector<Contact> rows;
    for (std::size_t c = 0; c < size_; ++c) rows.push_back((*this)[c]);
    return rows;
}

void ContactList::resize(std::size_t size) {
    size_ = size;
    if (pack_.size() < packs()) pack_.resize(packs());
}

void ContactList::append(const ContactPack& pack, int count) {
    const std::size_t first = size_;
    resize(size_ + std::size_t(count));
    if (first % lane_count == 0) {
        pack_[first / lane_count] = pack;
        return;
    }
    for (int lane = 0; lane < count; ++lane) {
        const std::size_t c = first + std::size_t(lane);
        copy_lane(pack_[c / lane_count], int(c % lane_count), pack, lane);
    }
}

void ContactList::copy(std::size_t c, const ContactList& from, std::size_t from_c) {
    copy_lane(pack_[c / lane_count], int(c % lane_count), from.pack_[from_c / lane_count],
              int(from_c % lane_count));
}

void ContactList::fill_lanes_beyond() {
    if (size_ % lane_count == 0) return;
    ContactPack& last = pack_[size_ / lane_count];
    const int lanes = int(size_ % lane_count);
    for (int lane = lanes; lane < lane_count; ++lane) copy_lane(last, lane, last, lanes - 1);
}

}  // namespace undertow::contact
