#pragma once

#include <cstdint>

namespace echofuse::board {

/// In every word of the stack that was never written: no address of this board, no small number, no round float.
inline constexpr std::uint32_t kStackPaint = 0x5ac0ffee;

}  // namespace echofuse::board
