#include "sph_solver/boundary/periodic.hpp"

#include <fmt/format.h>

#include "wire/errors.hpp"

namespace undertow::sph {

Periodic::Periodic(const std::vector<std::string>& axes, const std::optional<Box>& domain,
                   double support) {
    for (const std::string& name : axes) {
        const int axis = name[0] - 'x';
        if (along(axis)) continue;
        if (!domain)
            throw InputError(fmt::format(
                "sph.periodic: along {} there is no period: give sph.domain, whose extent it is.",
                name));
        const double length = domain->max[axis] - domain->min[axis];
        if (!(length >= 2 * support))
            throw InputError(fmt::format(
                "sph.periodic: the period along {} is {:.6g} m, the extent of sph.domain; it must "
                "be at least {:.6g} m, twice the support of the kernel, or a particle would meet "
                "itself: enlarge sph.domain or refine sph.spacing.",
                name, length, 2 * support));
        axes_.push_back({axis, domain->min[axis], length});
    }
}

bool Periodic::along(int axis) const {
    for (const Axis& a : axes_)
        if (a.axis == axis) return true;
    return false;
}

Vec3 balanced_gravity(const Case& input) {
    Vec3 g = input.info.gravity;
    for (const std::string& name : input.sph.periodic) g[name[0] - 'x'] = 0;
    return g;
}

}  // namespace undertow::sph
