// Of [fem]: motions that are told, and histories.

#include <algorithm>
#include <cctype>
#include <cmath>

#include "case/fem_sections.hpp"
#include "wire/number_text.hpp"

namespace undertow {

namespace {

void read_set_or_body(TableReader& reader, std::string& set, std::string& rigid,
                      const FemSettings& fem) {
    std::vector<std::string> bodies;
    for (const FemRigid& body : fem.rigid) bodies.push_back(body.name);
    if (reader.has("rigid")) {
        if (bodies.empty())
            reader.reject("rigid", "names a rigid body, but the case has no [[fem.rigid]].");
        reader.word("rigid", rigid, bodies);
        if (reader.has("set"))
            reader.reject("set", "is one thing too many: give set or rigid, not both.");
    } else {
        reader.text("rigid", rigid);  // known, for what finish() says
        read_set(reader, set, fem, block_sets);
    }
}

/// velocity, displacement or motion; `angle`.
void read_law(TableReader& reader, FemMotion& motion) {
    reader.vector("velocity", motion.velocity, "m/s");
    reader.number("start", motion.start, at_least(0, "s"));
    Range stop = at_least(0, "s");
    stop.infinite = true;
    reader.number("stop", motion.stop, stop);
    reader.number("ramp", motion.ramp, at_least(0, "s"));
    Vec3 constant{};
    reader.vector("displacement", constant, motion.displacement, "t", "m");
    if (reader.has("displacement") && motion.displacement.empty())
        for (const double u : constant)
            motion.displacement.emplace_back(number_text(u, 17), "t",
                                             reader.path() + ".displacement");
    reader.text("motion", motion.motion);
    reader.formula("angle", motion.angle, "t", "rad");
    reader.direction("axis", motion.axis);
    reader.vector("center", motion.center, "m");
}

void check_one_law(TableReader& reader, const FemMotion& motion) {
    const int laws = reader.has("velocity") + reader.has("displacement") + reader.has("motion");
    if (laws == 0 && !motion.angle)
        reader.reject("velocity",
                      "is missing: give velocity, displacement (numbers or formulas of t), a table "
                      "as motion, or angle. To hold nodes where they are use [[fem.support]].");
    if (laws > 1)
        reader.reject(reader.has("motion") ? "motion" : "displacement",
                      "is one law too many: velocity, displacement and motion exclude each other.");
    for (const char* key : {"start", "stop"})
        if (reader.has(key) && !reader.has("velocity"))
            reader.reject(key,
                          "has no effect: it belongs to velocity; a formula or a table says "
                          "itself when it moves.");
    if (motion.stop < motion.start + motion.ramp)
        reader.reject("stop", "is not allowed: it must be >= start + ramp, " +
                                  number_text(motion.start + motion.ramp) + " s.");
    if (reader.has("motion") && reader.has("angle"))
        reader.reject("angle", "is one law too many: a motion file may have a column for it.");
    if (reader.has("motion") && reader.has("ramp"))
        reader.reject("ramp", "has no effect on a table, which says itself how it begins.");
    for (const char* key : {"axis", "center"})
        if (reader.has(key) && !reader.has("angle") && !reader.has("motion"))
            reader.reject(key, "has no effect: give angle, or a motion file that has one.");
}

/// Where it begins nothing has moved yet: a jump would be an infinite velocity.
void check_start(TableReader& reader, const FemMotion& motion) {
    if (motion.ramp > 0) return;
    const auto check = [&](const char* key, const Expression& formula, const char* unit) {
        const double value = formula(0, 0, 0, 0);
        if (value != 0)
            reader.reject(key, "is " + number_text(value) + " " + unit +
                                   " at t = 0: the motion starts from the mesh, so it must be 0 "
                                   "there; give ramp, in which it rises smoothly.");
    };
    for (const Expression& formula : motion.displacement) check("displacement", formula, "m");
    if (motion.angle) check("angle", *motion.angle, "rad");
}

void check_plane(TableReader& reader, FemMotion& motion, const CaseInfo& info) {
    if (info.dimension != 2) return;
    if (!reader.has("directions")) motion.directions = {"x", "z"};
    for (const std::string& direction : motion.directions)
        if (direction == "y")
            reader.reject("directions",
                          "holds \"y\", but a 2D case does not move out of its plane.");
    if (motion.velocity[1] != 0 ||
        (!motion.displacement.empty() && motion.displacement[1].text() != "0"))
        reader.reject(reader.has("velocity") ? "velocity" : "displacement",
                      "is not allowed: a 2D case lies in the x-z plane, so y must be 0.");
    if (motion.axis[0] != 0 || motion.axis[2] != 0)
        reader.reject("axis", "is not allowed: in a 2D case things turn about y, [0, 1, 0].");
}

}  // namespace

void read_fem_motion(TableReader& reader, FemMotion& motion, const FemSettings& fem,
                     const CaseInfo& info) {
    reader.require("name", "a word for its columns");
    reader.text("name", motion.name);
    read_set_or_body(reader, motion.set, motion.rigid, fem);
    read_law(reader, motion);
    check_one_law(reader, motion);
    check_start(reader, motion);
    reader.words("directions", motion.directions, {"x", "y", "z"});
    check_plane(reader, motion, info);
    if (reader.has("directions") && motion.angle)
        reader.reject("directions", "has no effect with angle, which tells all directions.");
}

void read_initial_velocity(TableReader& reader, FemInitialVelocity& given, const FemSettings& fem,
                           const CaseInfo& info) {
    read_set_or_body(reader, given.set, given.rigid, fem);
    reader.vector("velocity", given.velocity, given.formulas, "xyz", "m/s");
    reader.vector("spin", given.spin, "rad/s");
    reader.vector("center", given.center, "m");
    given.has_center = reader.has("center");
    if (!reader.has("velocity") && !reader.has("spin"))
        reader.reject("velocity", "is missing: give velocity (numbers, or formulas of x, y and z) or "
                                  "spin, an angular velocity.");
    if (!given.rigid.empty() && !given.formulas.empty())
        reader.reject("velocity", "is not allowed: a rigid body moves as one; give numbers, and spin "
                                  "if it turns.");
    if (given.has_center && !reader.has("spin"))
        reader.reject("center", "has no effect without spin.");
    if (given.rigid.empty() && reader.has("spin"))
        reader.require("center", "the point in m that spin is about");
    if (info.dimension != 2) return;
    if (given.velocity[1] != 0 || (!given.formulas.empty() && given.formulas[1].text() != "0"))
        reader.reject("velocity", "is not allowed: a 2D case lies in the x-z plane, so y must be 0.");
    if (given.spin[0] != 0 || given.spin[2] != 0)
        reader.reject("spin", "is not allowed: in a 2D case things turn about y, [0, w, 0].");
}

void read_fem_history(TableReader& reader, FemHistory& history, const FemSettings& fem) {
    using Kind = FemHistoryKind;
    reader.require("name", "a word for its file");
    reader.require("kind", "one of \"point\", \"set\", \"section\", \"contact\"");
    reader.text("name", history.name);
    for (const char letter : history.name)
        if (!std::isalnum(static_cast<unsigned char>(letter)) && letter != '_' && letter != '-')
            reader.reject("name",
                          "is not allowed: it becomes part of a file's name, so letters, "
                          "digits, _ and - only.");
    reader.choice<Kind>("kind", history.kind,
                        {{"point", Kind::point},
                         {"set", Kind::set},
                         {"section", Kind::section},
                         {"contact", Kind::contact}});
    reader.number("every", history.every, at_least(0, "s"));
    reader.vector("point", history.point, "m");
    Vec3 normal{};
    if (reader.has("normal")) {
        reader.direction("normal", normal);
        history.normal = normal;
    } else {
        reader.vector("normal", normal, "");  // known, for what finish() says
    }
    std::vector<std::string> contacts;
    for (const FemContact& contact : fem.contact) contacts.push_back(contact.name);
    if (reader.has("contact"))
        reader.word("contact", history.contact, contacts);
    else
        reader.text("contact", history.contact);
    const bool section = history.kind == Kind::section;
    if (history.kind == Kind::set || (section && !reader.has("normal")))
        read_set(reader, history.set, fem,
                 section ? std::vector<std::string>{"block"} : block_sets);
    else
        reader.text("set", history.set);
    if (history.kind == Kind::point || section)
        reader.require("point", section ? "a point [x, y, z] of the plane; moments are about it"
                                        : "a point [x, y, z] of the undeformed mesh");
    if (history.kind == Kind::contact) reader.require("contact", "the name of a [[fem.contact]]");
    const auto only_for = [&](const char* key, bool allowed, const char* kinds) {
        if (reader.has(key) && !allowed)
            reader.reject(key, std::string("has no effect but on kind = ") + kinds + ".");
    };
    only_for("point", history.kind == Kind::point || section, "\"point\" and \"section\"");
    only_for("normal", section, "\"section\"");
    only_for("contact", history.kind == Kind::contact, "\"contact\"");
    only_for("set", history.kind == Kind::set || section, "\"set\" and \"section\"");
    if (section && reader.has("set") && reader.has("normal"))
        reader.reject("set",
                      "is one section too many: give the normal of a plane or the set whose "
                      "force on the rest is taken, not both.");
}

}  // namespace undertow
