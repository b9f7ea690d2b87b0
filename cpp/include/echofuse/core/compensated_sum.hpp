#pragma once

namespace echofuse {

/// Sum in float32 that keeps what rounding loses (Kahan, Communications of the ACM 8, 1965): its error does
/// not grow with the number of terms.
class CompensatedSum {
 public:
  void add(float term) {
    const float corrected = term - lost_;
    const float next = sum_ + corrected;
    lost_ = (next - sum_) - corrected;
    sum_ = next;
  }
  float value() const { return sum_; }

 private:
  float sum_ = 0.0f;
  float lost_ = 0.0f;
};

}  // namespace echofuse
