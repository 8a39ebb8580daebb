#pragma once
// The few HDF5 calls the result files need, with handles that close themselves. All failures throw
// InputError with the file and the object's name: on a working machine they mean a full disk or a
// folder that may not be written.

#include <hdf5.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace undertow::hdf5 {

/// Owns one identifier; `close` is the matching H5?close.
class Handle {
 public:
    Handle() = default;
    Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
    Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(id_, other.id_);
        std::swap(close_, other.close_);
        return *this;
    }
    ~Handle() {
        if (id_ >= 0) close_(id_);
    }
    operator hid_t() const { return id_; }

 private:
    hid_t id_ = -1;
    herr_t (*close_)(hid_t) = nullptr;
};

/// How files are opened: without locks, HDF5 1.10 would refuse to append while somebody looks at the
/// file. To be called before anything else of the library, which it keeps from printing a stack of its
/// own on every failure, and from trying again, when the program exits, what could not be written: it
/// would crash there.
Handle access_without_locks();

/// A file open for writing. Default library version and no locks: a reader may look at a running
/// case, and a file whose writer was killed opens without repair.
class File {
 public:
    static File create(const std::string& path);   // replaces what was there
    /// `room` [byte] is what will be added at most: if the disk has not that much left, the file
    /// stays untouched. HDF5 cannot undo half an append, and such a file opens no more.
    static File append(const std::string& path, std::uint64_t room);
    /// Flushes and closes; throws when the data did not reach the kernel.
    void close();

    void create_group(const std::string& name);
    void set_attribute(const std::string& object, const char* name, std::int64_t value);
    void set_attribute(const std::string& object, const char* name, std::vector<std::int64_t> values);
    void set_attribute(const std::string& object, const char* name, std::string_view text);

    /// An empty dataset of `columns` (0 = one-dimensional) that grows by rows; `chunk` rows at once.
    void create_growing(const std::string& name, hid_t type, hsize_t columns, hsize_t chunk);
    /// Adds rows at the end (`type` in memory); returns the index of the first new row.
    hsize_t append_rows(const std::string& name, hid_t type, hsize_t rows, const void* data);
    /// A virtual dataset over rows [first, first + rows) of `source` of the same file.
    void create_view(const std::string& name, const std::string& source, hsize_t first, hsize_t rows);

 private:
    File(std::string path, hid_t id);
    [[noreturn]] void fail(const std::string& what) const;
    Handle own(hid_t id, herr_t (*close)(hid_t), const std::string& what) const;

    std::string path_;
    Handle id_;
};

}  // namespace undertow::hdf5
