#include "fem_solver/setup/mesh_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "fem_solver/elements/corners.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

Vec3 edge(const Mesh& mesh, std::int32_t from, std::int32_t to) {
    const Vec3 &a = mesh.x[from], &b = mesh.x[to];
    return {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
}
double length(const Vec3& a) {
    return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}
Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Vec3& a, const Vec3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// What an element's shape comes down to.
struct Shape {
    double smallest = std::numeric_limits<double>::infinity();  // corner Jacobian, [m3] or [m2]
    double mean = 0;                                            // of the corners
    double longest = 0;                                         // [m] edge
    double shortest = std::numeric_limits<double>::infinity();  // [m] edge, or height of a
                                                                // tetrahedron that has such edges
    void edge(double l) {
        shortest = std::min(shortest, l);
        longest = std::max(longest, l);
    }
    void corner(double jacobian, int corners) {
        smallest = std::min(smallest, jacobian);
        mean += jacobian / corners;
    }
};

Shape hexahedron(const Mesh& mesh, const Hexahedron& h) {
    Shape shape;
    for (int corner = 0; corner < 8; ++corner) {
        Vec3 edges[3];
        for (int k = 0; k < 3; ++k) {
            edges[k] = edge(mesh, h[corner], h[corner_edges[corner][k]]);
            shape.edge(length(edges[k]));
        }
        shape.corner(dot(edges[0], cross(edges[1], edges[2])), 8);
    }
    return shape;
}

Shape tetrahedron(const Mesh& mesh, const Tetrahedron& t) {
    Shape shape;
    for (int a = 0; a < 4; ++a)
        for (int b = a + 1; b < 4; ++b)
            shape.longest = std::max(shape.longest, length(edge(mesh, t[a], t[b])));
    const double volume6 =
        dot(edge(mesh, t[0], t[1]), cross(edge(mesh, t[0], t[2]), edge(mesh, t[0], t[3])));
    shape.corner(volume6, 1);
    for (const auto& n : tetrahedron_face) {
        const double area2 =
            length(cross(edge(mesh, t[n[0]], t[n[1]]), edge(mesh, t[n[0]], t[n[2]])));
        // a regular tetrahedron is sqrt(2/3) of its edges high
        shape.shortest = std::min(shape.shortest, std::sqrt(1.5) * volume6 / area2);
    }
    return shape;
}

Shape shell(const Mesh& mesh, const Quad& q) {
    Shape shape;
    const Vec3 across = cross(edge(mesh, q[0], q[2]), edge(mesh, q[1], q[3]));
    for (int k = 0; k < 4; ++k) {
        const Vec3 next = edge(mesh, q[k], q[(k + 1) % 4]), last = edge(mesh, q[k], q[(k + 3) % 4]);
        shape.edge(length(next));
        shape.corner(dot(cross(next, last), across) / length(across), 4);
    }
    return shape;
}

/// Goes through the elements and remembers the worst.
class Check {
 public:
    explicit Check(const Mesh& mesh) : mesh_(mesh) {}

    template <class Element, class ShapeOf>
    void add(const std::vector<Element>& elements, ShapeOf&& shape_of, int dimension) {
        for (const Element& element : elements) look_at(shape_of(mesh_, element), dimension);
    }
    const MeshQuality& quality() const;

 private:
    void look_at(const Shape& shape, int dimension) {
        const std::size_t e = next_++;
        // flatter than this a corner cannot be told from a collapsed one in float positions
        if (!(shape.smallest > 1e-12 * std::pow(shape.longest, dimension))) {
            if (bad_++ == 0) {
                first_bad_ = e;
                first_jacobian_ = shape.smallest;
            }
            return;
        }
        if (shape.longest / shape.shortest > quality_.worst_aspect) {
            quality_.worst_aspect = shape.longest / shape.shortest;
            quality_.worst_aspect_element = e;
        }
        if (shape.smallest / shape.mean < quality_.worst_corner) {
            quality_.worst_corner = shape.smallest / shape.mean;
            quality_.worst_corner_element = e;
        }
    }

    const Mesh& mesh_;
    MeshQuality quality_;
    std::size_t next_ = 0, bad_ = 0, first_bad_ = 0;
    double first_jacobian_ = 0;
};

const MeshQuality& Check::quality() const {
    if (bad_ == 0) return quality_;
    const bool flat = mesh_.shape_of(first_bad_) == ElementShape::shell;
    throw InputError("fem: " + mesh_.element_name(first_bad_) + " of " + mesh_.source +
                     " is inverted or degenerate (smallest corner Jacobian " +
                     number_text(first_jacobian_, 3) + (flat ? " m2" : " m3") +
                     ", must be > 0); " + std::to_string(bad_) + " of " + std::to_string(next_) +
                     " elements are. Mend the mesh, or turn the node order round.");
}

}  // namespace

MeshQuality check_mesh(const Mesh& mesh) {
    if (mesh.n_elements() == 0)
        throw InputError("fem: the mesh " + mesh.source + " has no elements.");
    Check check(mesh);
    check.add(mesh.hexahedra, hexahedron, 3);
    check.add(mesh.tetrahedra, tetrahedron, 3);
    check.add(mesh.shells, shell, 2);
    return check.quality();
}

}  // namespace undertow::fem
