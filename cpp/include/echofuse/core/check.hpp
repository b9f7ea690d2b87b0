#pragma once

namespace echofuse {

/// Called when a programmer's promise is broken; never returns. The default aborts. Firmware defines its own
/// function of this name (the board's fault handler), which the linker then takes instead.
[[noreturn]] void check_failed(const char* expression, const char* file, int line);

}  // namespace echofuse

/// Always on: for promises that are cheap to test next to the work that they guard.
#define ECHOFUSE_CHECK(condition)                      \
  (static_cast<bool>(condition) ? static_cast<void>(0) \
                                : ::echofuse::check_failed(#condition, __FILE__, __LINE__))

/// On with -DECHOFUSE_DEBUG_CHECKS=1 (the sanitize preset): for every index, where a test costs as much as
/// the work.
#if defined(ECHOFUSE_DEBUG_CHECKS) && ECHOFUSE_DEBUG_CHECKS
#define ECHOFUSE_DEBUG_CHECK(condition) ECHOFUSE_CHECK(condition)
#else
#define ECHOFUSE_DEBUG_CHECK(condition) static_cast<void>(0)
#endif
