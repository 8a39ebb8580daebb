// What a checkpoint holds of contact, between two steps.

#include "checkpoint/archive.hpp"
#include "contact/penalty_contact.hpp"

namespace undertow::contact {

/// Packs as they are: what follows from a contact must follow in every bit.
void ContactList::archive(Archive& a) {
    std::vector<ContactPack> packs(pack_.begin(), pack_.begin() + std::ptrdiff_t(this->packs()));
    a("size", size_);
    a.flat<std::int32_t>("packs", packs);
    if (a.reading()) pack_ = std::move(packs);
}

void ForceLaw::archive(Archive& a) {
    a("memory", memory_);
    a("in_contact", in_contact_);
    a("inside", inside_);
    a("started", started_);
    a("start_inside/particles", start_inside_.particles);
    a("start_inside/deepest", start_inside_.deepest);
    a("start_inside/id", start_inside_.id);
    if (a.reading()) next_.assign(memory_.size(), 0);
}

void Detector::archive(Archive& a) {
    a("look_x", look_x_);
    a("look_travel", look_travel_);
    a("look_nearest", look_nearest_);
    a("distance", distance_);
    a("side_facet", side_facet_);
    a.rows("side_weight", side_weight_, [](std::array<double, 4>& w) { return std::tie(w); });
    a("x_nodes", x_nodes_);
    a("travel", travel_);
    a("node_speed", node_speed_);
}

void Ledger::archive(Archive& a) {
    a.flat<double>("energy", energy_);
    a("force", force_);
    a("v", v_);
    a.flat<std::int32_t>("nodes", nodes_);
    a.flat<double>("step", step_);
}

void PenaltyContact::archive(Archive& a) {
    a.object("detector", detector_);
    a.object("law", law_);
    a.object("ledger", ledger_);
    a("row", candidates_.row);
    a("start", candidates_.start);
    a("facet", candidates_.facet);
    a("distance", candidates_.distance);
    a.object("contacts", contacts_);
    a("mass", mass_);
    a("radius", radius_);
    a("stiffness", stiffness_);
    a("id", id_);
    a("settled", settled_);
    a("step_limit", step_limit_);
    a("last_dt", last_dt_);
    a("dt_before", dt_before_);
    a("kick", kick_);
}

}  // namespace undertow::contact
