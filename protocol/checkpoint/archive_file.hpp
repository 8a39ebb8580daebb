#pragma once
// An Archive as an HDF5 file. Written aside, flushed to the disk and renamed, so that a file under
// its own name is whole.

#include <cstdint>
#include <memory>
#include <string>

#include "checkpoint/archive.hpp"
#include "checkpoint/pulse.hpp"

namespace undertow {

struct WrittenFile {
    std::string name;  // without the folder
    std::string sha;   // SHA-256 of its bytes, hex
    std::int64_t bytes = 0;  // -1: not known
};

class ArchiveWriter final : public Archive {
 public:
    /// Creates path.tmp; throws std::runtime_error (E_IO) here and below when the disk is full or
    /// the folder cannot be written. What is not committed is removed. The pulse is called between
    /// pieces of some megabytes.
    explicit ArchiveWriter(const std::string& path, Pulse pulse = {});
    ~ArchiveWriter() override;
    bool reading() const override { return false; }

    /// Everything is on the disk under its own name afterwards.
    WrittenFile commit();

 private:
    void store(const std::string& path, Number number, std::size_t rows, std::size_t columns,
               const void* values) override;
    std::size_t find(const std::string&, Number, std::size_t) override { return 0; }
    void fetch(const std::string&, Number, std::size_t, std::size_t, void*) override {}
    [[noreturn]] void reject(const std::string& path, std::size_t, std::size_t) override;
    [[noreturn]] void fail(const std::string& what) const;
    void beat() const;

    struct Impl;
    std::unique_ptr<Impl> impl_;
};

class ArchiveReader final : public Archive {
 public:
    /// InputError when it cannot be opened.
    explicit ArchiveReader(const std::string& path);
    ~ArchiveReader() override;
    bool reading() const override { return true; }

 private:
    void store(const std::string&, Number, std::size_t, std::size_t, const void*) override {}
    std::size_t find(const std::string& path, Number number, std::size_t columns) override;
    void fetch(const std::string& path, Number number, std::size_t rows, std::size_t columns,
               void* values) override;
    [[noreturn]] void reject(const std::string& path, std::size_t stored,
                             std::size_t expected) override;

    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace undertow
