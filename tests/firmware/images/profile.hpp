#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "board.hpp"
#include "echofuse/core/tap.hpp"
#include "lockstep.hpp"

/// When each stage of one scan or frame ended, in ticks; sent only once all have.
class Profile {
 public:
  void begin() {
    n_marks_ = 0;
    begin_ = echofuse::board::ticks();
  }

  void end() { total_ = echofuse::board::ticks() - begin_; }

  echofuse::TapSink sink() {
    return echofuse::TapSink::marks(
        [](void* context, echofuse::TapId tap, echofuse::Span<const float>) {
          Profile& self = *static_cast<Profile*>(context);
          if (self.n_marks_ < self.marks_.size())
            self.marks_[self.n_marks_++] = {static_cast<std::uint8_t>(tap), echofuse::board::ticks()};
        },
        this);
  }

  void send() const {
    namespace board = echofuse::board;
    put(board::kTraceProfile, board::kProfileTotal, total_);
    std::uint32_t before = begin_;
    for (std::size_t i = 0; i < n_marks_; ++i) {
      put(board::kTraceProfile, marks_[i].tap, marks_[i].ticks - before);
      before = marks_[i].ticks;
    }
    put(board::kTraceStack, 0, static_cast<std::uint32_t>(board::stack_used_bytes()));
  }

 private:
  struct Mark {
    std::uint8_t tap;
    std::uint32_t ticks;
  };

  static void put(std::uint8_t kind, std::uint8_t id, std::uint32_t value) {
    std::uint8_t bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    (void)echofuse::board::trace(kind, id, {bytes, sizeof bytes});
  }

  std::array<Mark, 16> marks_{};
  std::size_t n_marks_ = 0;
  std::uint32_t begin_ = 0;
  std::uint32_t total_ = 0;
};
