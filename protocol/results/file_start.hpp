#pragma once

namespace undertow {

/// continued: the file of a run before is there; archive() says up to where it counts.
enum class FileStart { fresh, continued };

}  // namespace undertow
