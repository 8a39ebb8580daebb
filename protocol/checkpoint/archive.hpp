#pragma once
// State written to a checkpoint and read back by the same lines, so that the two cannot disagree:
//
//     void Nodes::archive(Archive& a) {
//         a.flat<double>("x", x);            a vector of structs made of doubles alone
//         a("mass", mass);                   numbers, strings, arrays and vectors of them
//         a.rows("near", near, [](auto& s) { return std::tie(s.particle, s.point); });
//         a.object("load", load);            a group of its own, by load.archive(a)
//     }
//
// A new variable needs one line. No file format here: archive_file.hpp has the HDF5 behind it, so
// that whoever has state needs to know neither files nor HDF5.

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

namespace undertow {

class Archive {
 public:
    enum class Number { f8, f4, i8, i4, u8, u4, i1, u1 };

    virtual ~Archive() = default;
    virtual bool reading() const = 0;

    /// Prefixes the names that follow, as long as it lives.
    class Group {
     public:
        Group(Archive& archive, const std::string& name)
            : archive_(archive), length_(archive.prefix_.size()) {
            archive_.prefix_ += "/" + name;
        }
        Group(const Group&) = delete;
        Group& operator=(const Group&) = delete;
        ~Group() { archive_.prefix_.resize(length_); }

     private:
        Archive& archive_;
        std::size_t length_;
    };

    template <class T>
    void operator()(const std::string& name, T& value) {
        if constexpr (std::is_same_v<T, bool>) {
            std::uint8_t byte = value;
            fixed(name, &byte, 1);
            value = byte != 0;
        } else if constexpr (std::is_enum_v<T>) {
            auto number = static_cast<std::int64_t>(value);
            fixed(name, &number, 1);
            value = static_cast<T>(number);
        } else {
            static_assert(std::is_arithmetic_v<T>, "use flat(), rows() or object()");
            fixed(name, &value, 1);
        }
    }
    void operator()(const std::string& name, std::string& text) {
        std::vector<std::uint8_t> bytes(text.begin(), text.end());
        (*this)(name, bytes);
        text.assign(bytes.begin(), bytes.end());
    }
    template <class T>
    void operator()(const std::string& name, std::vector<T>& values) {
        if constexpr (std::is_same_v<T, std::string>) {
            std::string all;  // each ends in a zero
            for (const std::string& text : values) all += text + '\0';
            (*this)(name, all);
            values.clear();
            for (std::size_t at = 0; at < all.size(); at = all.find('\0', at) + 1)
                values.emplace_back(all.c_str() + at);
        } else {
            if (reading()) values.resize(find(path(name), number<T>(), 1));
            data(name, number<T>(), values.size(), 1, values.data());
        }
    }
    template <class T, std::size_t n>
    void operator()(const std::string& name, std::array<T, n>& values) {
        fixed(name, values.data(), n);
    }
    template <class T, std::size_t n>
    void operator()(const std::string& name, T (&values)[n]) {
        fixed(name, values, n);
    }

    /// As many numbers as there are; another count in the file is an error.
    template <class T>
    void fixed(const std::string& name, T* values, std::size_t n) {
        if (reading() && find(path(name), number<T>(), 1) != n)
            reject(path(name), find(path(name), number<T>(), 1), n);
        data(name, number<T>(), n, 1, values);
    }
    /// Structs of T alone: a table with a row for each.
    template <class T, class Struct>
    void flat(const std::string& name, std::vector<Struct>& values) {
        static_assert(std::is_trivially_copyable_v<Struct> && sizeof(Struct) % sizeof(T) == 0);
        constexpr std::size_t columns = sizeof(Struct) / sizeof(T);
        if (reading()) values.resize(find(path(name), number<T>(), columns));
        data(name, number<T>(), values.size(), columns, values.data());
    }
    /// One such struct.
    template <class T, class Struct>
    void flat(const std::string& name, Struct& value) {
        static_assert(std::is_trivially_copyable_v<Struct> && sizeof(Struct) % sizeof(T) == 0);
        fixed(name, reinterpret_cast<T*>(&value), sizeof(Struct) / sizeof(T));
    }
    /// Structs of any numbers as a table of doubles; fields(row) returns them by std::tie.
    template <class Row, class Fields>
    void rows(const std::string& name, std::vector<Row>& values, Fields&& fields) {
        Row sample{};
        std::size_t columns = 0;
        std::apply([&](auto&... field) { ((columns += count_of(field)), ...); }, fields(sample));
        if (reading()) values.resize(find(path(name), Number::f8, columns));
        std::vector<double> table(values.size() * columns);
        double* at = table.data();
        if (!reading())
            for (Row& row : values)
                std::apply([&](auto&... field) { (put(field, at), ...); }, fields(row));
        data(name, Number::f8, values.size(), columns, table.data());
        at = table.data();
        if (reading())
            for (Row& row : values)
                std::apply([&](auto&... field) { (take(field, at), ...); }, fields(row));
    }
    template <class T>
    void object(const std::string& name, T& value) {
        const Group group(*this, name);
        value.archive(*this);
    }
    /// What must be the same when it is read back as when it was written; `what` for the message:
    /// "the mesh has 120 nodes". False when it is not.
    template <class T>
    bool same(const std::string& name, const T& value) {
        T stored = value;
        (*this)(name, stored);
        return stored == value;
    }

 protected:
    virtual void store(const std::string& path, Number number, std::size_t rows,
                       std::size_t columns, const void* values) = 0;
    /// Rows of what is stored; throws when there is no such table.
    virtual std::size_t find(const std::string& path, Number number, std::size_t columns) = 0;
    virtual void fetch(const std::string& path, Number number, std::size_t rows,
                       std::size_t columns, void* values) = 0;
    [[noreturn]] virtual void reject(const std::string& path, std::size_t stored,
                                     std::size_t expected) = 0;

 private:
    std::string path(const std::string& name) const { return prefix_ + "/" + name; }
    void data(const std::string& name, Number number, std::size_t rows, std::size_t columns,
              void* values) {
        if (reading())
            fetch(path(name), number, rows, columns, values);
        else
            store(path(name), number, rows, columns, values);
    }

    template <class T>
    static constexpr Number number() {
        if constexpr (std::is_same_v<T, double>)
            return Number::f8;
        else if constexpr (std::is_same_v<T, float>)
            return Number::f4;
        else {
            static_assert(std::is_integral_v<T> && !std::is_same_v<T, bool>);
            constexpr bool plus = std::is_unsigned_v<T>;
            return sizeof(T) == 8   ? (plus ? Number::u8 : Number::i8)
                   : sizeof(T) == 4 ? (plus ? Number::u4 : Number::i4)
                                    : (plus ? Number::u1 : Number::i1);
        }
    }
    template <class T>
    static constexpr std::size_t count_of(const T& field) {
        if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
            return 1;
        else
            return sizeof(field) / sizeof(field[0]) * count_of(field[0]);  // arrays of arrays too
    }
    template <class T>
    static void put(const T& field, double*& at) {
        if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
            *at = static_cast<double>(field);
            if constexpr (std::is_integral_v<T> && sizeof(T) == 8)
                if (static_cast<T>(*at) != field)
                    throw std::logic_error(
                        "a whole number beyond 2^53 goes into no table of doubles");
            ++at;
        } else {
            for (std::size_t k = 0; k < sizeof(field) / sizeof(field[0]); ++k) put(field[k], at);
        }
    }
    template <class T>
    static void take(T& field, double*& at) {
        if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
            field = static_cast<T>(*at++);
        else
            for (std::size_t k = 0; k < sizeof(field) / sizeof(field[0]); ++k) take(field[k], at);
    }

    std::string prefix_;
};

}  // namespace undertow
