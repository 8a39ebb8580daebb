#pragma once
// summary.<program>.json: what a run of one program found and cost. The launcher joins the parts
// into summary.json.

#include <cstdint>
#include <memory>
#include <string>

namespace undertow {

class Summary {
 public:
    Summary();
    ~Summary();
    /// key like "sph.particle_steps_per_s"; dots make nested objects.
    void set(const std::string& key, double value);
    void set(const std::string& key, std::int64_t value);
    void set(const std::string& key, bool value);
    void set(const std::string& key, const std::string& value);
    void set(const std::string& key, const char* value) { set(key, std::string(value)); }
    /// Written aside and renamed.
    void write(const std::string& path) const;

 private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace undertow
