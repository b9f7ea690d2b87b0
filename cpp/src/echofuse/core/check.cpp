#include "echofuse/core/check.hpp"

#include <cstdlib>

namespace echofuse {

// Alone in its file, so that a program with a check_failed of its own does not link std::abort either.
[[gnu::weak]] void check_failed(const char* /*expression*/, const char* /*file*/, int /*line*/) {
  std::abort();
}

}  // namespace echofuse
