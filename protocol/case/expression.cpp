#include "case/expression.hpp"

#include <muParser.h>

#include <cmath>

#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow {

struct Expression::Compiled {
    double value[4]{};  // of x, y, z, t; the parser reads them where they are
    mu::Parser parser;
};

namespace {

/// "x, y and z"
std::string allowed(const std::string& variables) {
    std::string text;
    for (std::size_t k = 0; k < variables.size(); ++k)
        text += std::string(k == 0                      ? ""
                            : k + 1 == variables.size() ? " and "
                                                        : ", ") +
                variables[k];
    return text;
}

/// Position of a "=" that is no comparison; npos if there is none. muParser would assign.
std::size_t assignment(const std::string& text) {
    const std::string before = "=<>!";
    for (std::size_t k = 0; k < text.size(); ++k) {
        if (text[k] != '=') continue;
        const bool ends = k > 0 && before.find(text[k - 1]) != std::string::npos;
        const bool begins = k + 1 < text.size() && text[k + 1] == '=';
        if (!ends && !begins) return k;
    }
    return std::string::npos;
}

}  // namespace

Expression::Expression(const std::string& text, const std::string& variables,
                       const std::string& origin)
    : text_(text), variables_(variables), origin_(origin), compiled_(new Compiled) {
    const auto reject = [&](const std::string& why) {
        throw InputError(origin_ + " = \"" + text_ + "\" is no formula: " + why + "; it may use " +
                         allowed(variables_) +
                         ", pi, numbers, + - * / ^ and functions such as sin, exp, sqrt, min.");
    };
    if (const std::size_t at = assignment(text_); at != std::string::npos)
        reject("nothing can be assigned, but there is a = at position " + std::to_string(at + 1));
    mu::Parser& parser = compiled_->parser;
    try {
        parser.DefineConst("pi", M_PI);
        const std::string all = "xyzt";
        for (const char variable : variables_)
            parser.DefineVar(std::string(1, variable), &compiled_->value[all.find(variable)]);
        parser.SetExpr(text_);
        int results = 0;
        parser.Eval(results);
        if (results != 1) reject("it has " + std::to_string(results) + " values, one is expected");
    } catch (const mu::Parser::exception_type& error) {
        if (!error.GetToken().empty() && error.GetCode() == mu::ecUNASSIGNABLE_TOKEN)
            reject("\"" + error.GetToken() + "\" is not known");
        std::string why = error.GetMsg();
        while (!why.empty() && (why.back() == '.' || why.back() == '!')) why.pop_back();
        if (!why.empty()) why[0] = static_cast<char>(std::tolower(why[0]));
        reject(why);
    }
}

Expression::~Expression() = default;
Expression::Expression(const Expression& other)
    : Expression(other.text_, other.variables_, other.origin_) {}
Expression::Expression(Expression&& other) noexcept = default;
Expression& Expression::operator=(const Expression& other) {
    return *this = Expression(other);
}
Expression& Expression::operator=(Expression&& other) noexcept = default;

double Expression::operator()(double x, double y, double z, double t) const {
    double* const value = compiled_->value;
    value[0] = x, value[1] = y, value[2] = z, value[3] = t;
    double result = NAN;
    try {
        result = compiled_->parser.Eval();
    } catch (const mu::Parser::exception_type&) {  // some functions throw out of their domain
    }
    if (std::isfinite(result)) return result;
    std::string where;
    const double point[4] = {x, y, z, t};
    for (const char variable : variables_)
        where += (where.empty() ? "" : ", ") + std::string(1, variable) + " = " +
                 number_text(point[std::string("xyzt").find(variable)], 6);
    throw InputError(origin_ + " = \"" + text_ + "\" is not finite at " + where +
                     "; it must have a value everywhere it is needed.");
}

}  // namespace undertow
