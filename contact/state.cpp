// What a checkpoint holds of contact, between two steps.

#include "checkpoint/archive.hpp"
#include "contact/penalty_contact.hpp"

namespace undertow::contact {

namespace {

void archive_contacts(Archive& a, const char* name, std::vector<Contact>& contacts) {
    const auto fields = [](Contact& c) {
        return std::tie(c.particle, c.facet, c.weight, c.point[0], c.point[1], c.point[2],
                        c.normal[0], c.normal[1], c.normal[2], c.depth, c.closing, c.slip[0],
                        c.slip[1], c.slip[2], c.stiffness, c.mass, c.normal_force,
                        c.damping_force, c.friction[0], c.friction[1], c.friction[2], c.force[0],
                        c.force[1], c.force[2]);
    };
    a.rows(name, contacts, fields);
}

}  // namespace

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
    a.rows("look", look_,
           [](Look& l) { return std::tie(l.x[0], l.x[1], l.x[2], l.travel, l.nearest); });
    a("distance", distance_);
    a.rows("side", side_, [](Side& s) { return std::tie(s.facet, s.weight); });
    a("x_nodes", x_nodes_);
    a("travel", travel_);
    a("node_speed", node_speed_);
}

void Ledger::archive(Archive& a) {
    a.flat<double>("energy", energy_);
    a("force", force_);
    a("v", v_);
    a.rows("nodes", nodes_, [](KeptNode& n) {
        return std::tie(n.node, n.force[0], n.force[1], n.force[2], n.v[0], n.v[1], n.v[2]);
    });
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
    archive_contacts(a, "contacts", contacts_);
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
