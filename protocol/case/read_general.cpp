// [case], [time], [output] and [coupling].

#include <algorithm>
#include <cctype>

#include "case/sections.hpp"

namespace undertow {

void read_info(TableReader& reader, CaseInfo& info) {
    reader.require("name", "a word, which also names the folder of the results");
    reader.text("name", info.name);
    const bool plain = std::all_of(info.name.begin(), info.name.end(), [](unsigned char c) {
        return std::isalnum(c) || c == '_' || c == '-' || c == '.';
    });
    if (!plain || info.name.front() == '.')
        if (!info.name.empty())
            reader.reject("name",
                          "is not allowed: it names a folder, so letters, digits, _ - and . "
                          "only, not starting with a dot.");
    info.title = info.name;
    reader.text("title", info.title);
    reader.whole("dimension", info.dimension, 2, 3);
    reader.number("thickness", info.thickness, positive("m"));
    if (info.dimension == 3 && reader.has("thickness"))
        reader.reject("thickness", "belongs to 2D cases: remove it or set dimension = 2.");
    reader.vector("gravity", info.gravity, "m/s2");
    if (info.dimension == 2 && info.gravity[1] != 0)
        reader.reject("gravity",
                      "is not allowed: a 2D case lies in the x-z plane, so y must be 0.");
}

void read_time(TableReader& reader, TimeSettings& time) {
    reader.require("end", "the simulated time in s");
    reader.number("end", time.end, positive("s"));
    Range step = positive("s");
    step.infinite = true;
    reader.number("max_step", time.max_step, step);
    reader.number("min_step", time.min_step, positive("s"));
    reader.number("growth", time.growth, above_up_to(1, 2));
    if (time.min_step >= time.max_step)
        reader.reject("min_step", "is not allowed: it must be below time.max_step.");
}

void read_start(TableReader& reader, StartSettings& start) {
    reader.number("settle", start.settle, at_least(0, "s"));
    reader.number("damping", start.damping, at_least(0, "1/s"));
}

void read_output(TableReader& reader, OutputSettings& output) {
    reader.number("fields_every", output.fields_every, positive("s"));
    reader.number("history_every", output.history_every, at_least(0, "s"));
    reader.flag("contact_fields", output.contact_fields);
    reader.number("contact_every", output.contact_every, at_least(0, "s"));
    if (!output.contact_fields && output.contact_every > 0)
        reader.reject("contact_every", "has nothing to write: set output.contact_fields = true, or remove it.");
}

void read_checkpoint(TableReader& reader, CheckpointSettings& checkpoint) {
    checkpoint.present = true;
    reader.number("every", checkpoint.every, at_least(0, "s"));
    reader.number("every_wall", checkpoint.every_wall, at_least(0, "s"));
    reader.flag("on_interrupt", checkpoint.on_interrupt);
    reader.flag("at_end", checkpoint.at_end);
    reader.whole("keep", checkpoint.keep, 1, 1000);
}

void read_coupling(TableReader& reader, CouplingSettings& coupling) {
    reader.choice<StiffnessLaw>("law", coupling.law,
                                {{"fluid", StiffnessLaw::fluid}, {"eq11", StiffnessLaw::eq11}});
    reader.number("stiffness_factor", coupling.stiffness_factor, positive());
    reader.number("beta", coupling.beta, between(0, 4));
    reader.number("damping", coupling.damping, closed(0, 0.1));
    reader.number("friction", coupling.friction, at_least(0));
    reader.choice<FrictionLaw>(
        "friction_law", coupling.friction_law,
        {{"coulomb", FrictionLaw::coulomb}, {"viscous", FrictionLaw::viscous}});
    reader.number("viscous_coefficient", coupling.viscous_coefficient, at_least(0, "N s/m"));
    if (coupling.friction_law == FrictionLaw::viscous && coupling.viscous_coefficient == 0)
        reader.reject("friction_law", "needs coupling.viscous_coefficient > 0 N s/m.");
    reader.number("skin", coupling.skin, above_up_to(0, 2, "particle spacings"));
    reader.word("transport", coupling.transport, {"shm", "ipc", "tcp"});
    reader.number("deadline", coupling.deadline, positive("s"));
    reader.number("join_timeout", coupling.join_timeout, positive("s"));
    reader.tables("patch", [&](TableReader& entry) {
        PressurePatch patch;
        entry.require("name", "a word for the column of patches.csv");
        entry.require("box", "the box { min, max } whose contacts count");
        entry.require("area", "the area in m2 by which the force is divided");
        entry.text("name", patch.name);
        entry.box("box", patch.box);
        entry.number("area", patch.area, positive("m2"));
        entry.number("window", patch.window, at_least(0, "s"));
        coupling.patch.push_back(patch);
    });
}

}  // namespace undertow
