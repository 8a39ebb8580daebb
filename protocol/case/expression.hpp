#pragma once
// A formula of a case file: "0.1*sin(2*pi*x)". Functions and operators are muParser's (sin, cos,
// tanh, exp, ln, sqrt, abs, min, max, ..., + - * / ^, comparisons, a ? b : c); pi is defined.

#include <memory>
#include <string>

namespace undertow {

class Expression {
 public:
    /// variables: those of "xyzt" that may occur. origin: where the text stands and what it is for,
    /// "case.toml:12:11: sph.fill.0.velocity". InputError: the text is no formula.
    Expression(const std::string& text, const std::string& variables, const std::string& origin);
    ~Expression();
    // A copy is compiled anew. One object is not for several threads at once: each takes a copy.
    Expression(const Expression& other);
    Expression(Expression&& other) noexcept;
    Expression& operator=(const Expression& other);
    Expression& operator=(Expression&& other) noexcept;

    /// Value at x, y, z [m] and t [s]. InputError: it is not finite there.
    double operator()(double x, double y, double z, double t = 0) const;

    const std::string& text() const { return text_; }

 private:
    struct Compiled;
    std::string text_, variables_, origin_;
    std::unique_ptr<Compiled> compiled_;
};

}  // namespace undertow
