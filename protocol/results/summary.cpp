#include "results/summary.hpp"

#include <nlohmann/json.hpp>

#include "results/atomic_file.hpp"

namespace undertow {

using Json = nlohmann::ordered_json;

struct Summary::Impl {
    Json root = Json::object();

    Json& at(const std::string& key) {
        Json* node = &root;
        std::size_t start = 0;
        for (std::size_t dot; (dot = key.find('.', start)) != std::string::npos; start = dot + 1)
            node = &(*node)[key.substr(start, dot - start)];
        return (*node)[key.substr(start)];
    }
};

Summary::Summary() : impl_(std::make_unique<Impl>()) {}
Summary::~Summary() = default;

// JSON knows no NaN or infinity: nlohmann writes them as null, which readers can tell from 0.
void Summary::set(const std::string& key, double value) {
    impl_->at(key) = value;
}
void Summary::set(const std::string& key, std::int64_t value) {
    impl_->at(key) = value;
}
void Summary::set(const std::string& key, bool value) {
    impl_->at(key) = value;
}
void Summary::set(const std::string& key, const std::string& value) {
    impl_->at(key) = value;
}

void Summary::write(const std::string& path) const {
    write_file_atomically(path,
                          impl_->root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace undertow
